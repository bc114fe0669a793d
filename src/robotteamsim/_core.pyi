# The C++ core, made by src/bindings; typed at its public faces in the floors.
from typing import Any

def __getattr__(name: str) -> Any: ...
