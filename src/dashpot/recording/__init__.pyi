from .keep import record as record
from .lines import SerialLine as SerialLine
from .paced import Paced as Paced
from .paced import replay as replay
from .paced import simulated as simulated
from .recorder import Block as Block
from .recorder import Description as Description
from .recorder import Recorder as Recorder
