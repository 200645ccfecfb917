"""Results for people: text and tables, pictures, pages, files."""
