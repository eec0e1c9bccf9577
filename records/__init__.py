"""The small frozen records that the stages hand to one another, with their files."""
