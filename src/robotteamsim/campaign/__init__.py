"""Many trials of a scenario: their design, execution on many processes, store and tables."""

from robotteamsim.campaign.design import Cell, Design, Trial, make_design
from robotteamsim.campaign.paths import decode_paths
from robotteamsim.campaign.store import Store, StoredCampaign, check_folder, open_store, read_store
from robotteamsim.campaign.trial import Outcome, run_trial

__all__ = [
    "Cell",
    "Design",
    "Outcome",
    "Store",
    "StoredCampaign",
    "Trial",
    "check_folder",
    "decode_paths",
    "make_design",
    "open_store",
    "read_store",
    "run_trial",
]
