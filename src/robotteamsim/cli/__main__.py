"""`python -m robotteamsim.cli`."""

import sys

from robotteamsim.cli import main

sys.exit(main())
