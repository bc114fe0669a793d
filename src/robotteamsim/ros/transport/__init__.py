"""How nodes subscribe, publish and wait for the messages of one step."""
