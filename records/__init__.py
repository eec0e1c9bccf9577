"""Files and numbers in; the small frozen records that the stages hand to one another, and their text, out."""
