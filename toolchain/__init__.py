"""C in; libraries for this computer and images for the board out, by one compiler and a cache named by content."""
