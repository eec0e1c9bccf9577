"""A board or a log goes in, a live page for browsers of this computer comes out: what is watched, the thread that moves it, the server."""
