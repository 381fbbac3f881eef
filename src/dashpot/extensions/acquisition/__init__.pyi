from .record_to_file import record as record
from .recorder import Block as Block
from .recorder import Description as Description
from .recorder import Recorder as Recorder
from .replay_device import PacedReplay as PacedReplay
from .replay_device import create_simulated_device as create_simulated_device
from .replay_device import replay as replay
from .serial_line import SerialLine as SerialLine
