"""The colours of rviz, plots, films and reports: one colour has one meaning everywhere.

States and the first robots have the hues of Okabe and Ito's palette [okabe2008], which people with any common kind of
colour blindness can tell apart. States also differ in shape, because no palette suffices for everybody. All colours are
codes such as "#56b4e9", which also suit a browser; `css` gives them as custom properties of a style sheet.
"""

from collections.abc import Mapping

BLACK, WHITE = "#000000", "#ffffff"
ORANGE, SKY_BLUE, GREEN, YELLOW = "#e69f00", "#56b4e9", "#009e73", "#f0e442"
BLUE, VERMILLION, PURPLE = "#0072b2", "#d55e00", "#cc79a7"

# The colours after the first four are as far as possible from all others, for normal and for colour-blind sight.
ROBOTS = (SKY_BLUE, ORANGE, PURPLE, BLUE, "#b4c3a5", "#a569ff", "#96d2ff", "#e1c369", "#d200c3", "#87b478")
EXCLUDED_ROBOT = "#9aa0a8"
ROBOT_BODY = "#14171c"

WAITING, HEARD, SAVED = VERMILLION, YELLOW, GREEN
VICTIMS = {"waiting": WAITING, "heard": HEARD, "saved": SAVED}
CASUALTY = "#6b6f76"
"""Victims who have collapsed or died."""
FLAME, SMOKE, CHAR, HOT = "#ff5a1f", "#7d8087", "#26211d", "#a8452a"
TURNOUT_COAT, REFLECTIVE, HELMET = "#d9b36c", "#e6ff4f", "#d7263d"
"""Firefighters, in the colours of their clothes."""
RESCUED = {
    "waiting": WAITING,
    "heard": HEARD,
    "located": ORANGE,
    "reported": SKY_BLUE,
    "reached": PURPLE,
    "carried": PURPLE,
    "safe": SAVED,
}
"""Victims whom firefighters save."""
FLEEING = BLUE
"""People who walk to an exit and need no help."""
VICTIM_STATES = VICTIMS | RESCUED | {"fleeing": FLEEING, "collapsed": CASUALTY, "dead": CASUALTY}
SKIN = "#f1d3b8"
OPEN_AREA, TARGET_AREA, EXPLORED_AREA = "#c3ccd6", WHITE, GREEN
COLLISION = VERMILLION
FOUND, WRONGLY_FOUND = "#a6d854", "#ff2d55"
"""What a team has found of a building that it does not know; walls that are not there."""

STRONG_LINK, WEAK_LINK, ENDANGERED_LINK = GREEN, YELLOW, VERMILLION
RELAYED = "#8d97a3"
HOPS, FIEDLER = BLUE, PURPLE
OURS, THEIRS = BLUE, ORANGE
"""In a report: the missions of a campaign, and any others to compare them with."""

VOICE = ((10.0, "#5a2a9c"), (30.0, "#8a2f9e"), (50.0, "#c73a7d"), (70.0, "#f0713f"), (95.0, "#ffc05c"))
"""On a dark ground, by voice level [dB]."""
# ColorBrewer's sequential maps, by their names in Matplotlib, which are colour-blind-safe, too.
VOICE_MAP, SIGNAL_MAP, LOSS_MAP, HEAT_MAP = "YlOrRd", "YlGnBu", "YlGnBu_r", "GnBu"

# Plots, on a light ground.
PAPER, FLOOR, UNSEEN = WHITE, "#f6f5f2", "#dedcd6"
INK, SOFT_INK, FAINT_INK, GRID, CARD = "#16202e", "#4a5563", "#77746c", "#dfe3e8", "#f3f5f7"
AXIS = "#8a94a3"
SOLIDS = {"wall": "#3b4252", "block": "#5a6275", "pillar": "#767f92"}
GLASS = "#4fb3bf"
BAY = "#c9c6bd"
DOORS = {"normal": "#b07a2a", "fireproof": "#8f2d1f"}
OBJECT = "#a9793f"
DIVERGES, MEAN_CONVERGES, CONVERGES = WHITE, "#f3cf80", "#aad9f4"

# rviz, on a dark ground.
BACKGROUND = "#14181e"
DARK_FLOOR, DARK_FLOOR_EDGE = "#2f3640", "#1f242c"
LIT_SOLIDS = {"wall": "#dcd8ce", "block": "#b4b2ad", "pillar": "#c9cdd2"}
WALL_EDGE = "#8d8a83"
LIT_DOORS = {"normal": "#c58b4e", "fireproof": "#b8503c"}
BOX, BARREL = "#c9924f", "#6f93a8"
HEADLINE = "#f4f1ea"


# The viewer's page, light and dark.
LIGHT_PAGE = {
    "back": FLOOR,
    "card": PAPER,
    "ink": INK,
    "soft": SOFT_INK,
    "line": GRID,
    "accent": BLUE,
    "floor": "#e9e7e1",
    "floor-edge": "#cfccc3",
    "sky-light": WHITE,
    "ground-light": "#8a8f98",
}
DARK_PAGE = LIGHT_PAGE | {
    "back": BACKGROUND,
    "card": "#1d232b",
    "ink": "#eef1f4",
    "soft": "#a3adb9",
    "line": "#333c47",
    "accent": SKY_BLUE,
    "floor": DARK_FLOOR,
    "floor-edge": DARK_FLOOR_EDGE,
}


def robot_colour(index: int) -> str:
    """Return the colour of a robot, or of a swarm, by its index >= 0; the first 30 differ.

    After each ten, the same hues follow in a lighter and then in a darker tone.
    """
    rounds, place = divmod(index, len(ROBOTS))
    other, share = ((WHITE, 0.0), (WHITE, 0.55), (BLACK, 0.4))[rounds % 3]
    return mixed(ROBOTS[place], other, share)


def text_on(ground: str) -> str:
    """Return the colour of texts on a ground: INK or WHITE, whichever has more contrast."""
    luminance = sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear(ground), strict=True))
    return INK if luminance > 0.2 else WHITE


def mixed(low: str, high: str, share: float) -> str:
    """Return the colour at a fraction `share` (0..1) from `low` to `high`."""
    parts = (a + share * (b - a) for a, b in zip(rgb(low), rgb(high), strict=True))
    return "#" + "".join(f"{round(255.0 * part):02x}" for part in parts)


def rgb(code: str) -> tuple[float, float, float]:
    """Return red, green and blue, each 0..1, of a code such as "#56b4e9"."""
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return (red, green, blue)


def linear(code: str) -> tuple[float, float, float]:
    """Return red, green and blue of a code, each 0..1 in proportion to its light: linear sRGB."""
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in rgb(code))
    return (red, green, blue)


def css() -> str:
    """Return the colours of a report as custom properties, such as "--saved: #009e73;"."""
    return properties(
        {
            "ink": INK,
            "soft": SOFT_INK,
            "line": GRID,
            "paper": PAPER,
            "card": CARD,
            "link": BLUE,
            **VICTIMS,
            "floor": FLOOR,
            "explored": EXPLORED_AREA,
            "strong-link": STRONG_LINK,
            "weak-link": WEAK_LINK,
            "endangered-link": ENDANGERED_LINK,
            **{f"robot-{index}": code for index, code in enumerate(ROBOTS)},
        }
    )


def properties(colours: Mapping[str, str]) -> str:
    """Return colours by name as custom properties of a style sheet."""
    return " ".join(f"--{name}: {code};" for name, code in colours.items())
