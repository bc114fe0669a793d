"""The command centre, firefighters, and the robots that connect them."""
