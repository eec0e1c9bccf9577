"""The live page: what is watched, the thread that moves it, the server that shows it to browsers of this computer."""
