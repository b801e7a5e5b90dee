"""What a run leaves behind: labelled data, pictures, files."""
