"""What Python may call of the emulated chip in C: calls in, status, bytes and counts out."""
