"""Results of analyses: labelled data, pictures and files."""
