"""Writing of complete files and folders, and reading of text files."""
