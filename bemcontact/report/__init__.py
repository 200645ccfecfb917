"""Results for people: words and tables, pictures, files."""
