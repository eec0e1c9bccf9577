"""A log and its plant in; out where columns leap as no axis does: another recording, a sign that turns, columns exchanged."""
