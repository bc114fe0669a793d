"""Subscribing, publishing, and waiting for the messages of one step."""
