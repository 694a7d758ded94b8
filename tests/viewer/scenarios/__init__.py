# ruff: noqa: F401 - each function that is imported here is a scenario
"""What a user does in the window, and what must come of it.  Each function is run by `tests.viewer.window`."""

import inspect

from tests.viewer.scenarios.at_home import at_home
from tests.viewer.scenarios.closeup import closeup
from tests.viewer.scenarios.closing import closing_while_experimenting, closing_while_loading, closing_while_tracing
from tests.viewer.scenarios.comparing import comparing
from tests.viewer.scenarios.culling import culling, explaining
from tests.viewer.scenarios.drawing import difference, fates, views
from tests.viewer.scenarios.failing import failing
from tests.viewer.scenarios.figure1 import figure1
from tests.viewer.scenarios.files import browsing, capturing, dropping, reopening
from tests.viewer.scenarios.finding import finding
from tests.viewer.scenarios.fitting import fitting
from tests.viewer.scenarios.hunting import hunting
from tests.viewer.scenarios.lamps import lamps
from tests.viewer.scenarios.moving import flying, playing, resizing
from tests.viewer.scenarios.navigating import navigating
from tests.viewer.scenarios.panels import hiding, looks, panels
from tests.viewer.scenarios.runs import asking, experimenting, figures, filming, zooming
from tests.viewer.scenarios.savings import savings
from tests.viewer.scenarios.starting import starting
from tests.viewer.scenarios.stepping import stepping
from tests.viewer.scenarios.taking import taking
from tests.viewer.scenarios.touring import touring
from tests.viewer.scenarios.what_if import what_if
from tests.viewer.scenarios.why import why

SCENARIOS = {name: scenario for name, scenario in list(globals().items()) if inspect.isfunction(scenario)}
