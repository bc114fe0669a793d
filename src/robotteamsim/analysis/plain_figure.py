"""Figures in which names are text."""

from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.text import Text


class PlainFigure(Figure):
    """A figure that draws each text as it is: `$` in a name does not begin a formula of Matplotlib's mathtext."""

    def draw(self, renderer: RendererBase) -> None:
        """See `Figure.draw`."""
        for text in self.findobj(Text):
            text.set_parse_math(False)
        super().draw(renderer)
