"""`python -m robotteamsim.cli`."""

import sys

from robotteamsim.cli.main import main

sys.exit(main())
