"""Mutation score: law.c, table and twin with small wrong changes in, the share that the equality checks notice out."""
