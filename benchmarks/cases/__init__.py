"""What is compared: every case makes rows of the table, and some make a picture."""
