from .comparison import LotComparison as LotComparison
from .comparison import compare_two_lots as compare_two_lots
from .input_files import Entry as Entry
from .limits import Limits as Limits
from .limits import read_limits as read_limits
from .lot import Lot as Lot
