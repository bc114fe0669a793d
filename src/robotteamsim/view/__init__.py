"""Shows a mission in a browser: live, or as one HTML file."""
