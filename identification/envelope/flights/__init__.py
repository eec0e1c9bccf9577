"""From flight tests in files, or inputs to fly, to flights in SI units, looked at for what they can tell."""
