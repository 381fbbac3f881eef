# signatures of the public functions whose results depend on what they are given
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, Unpack, overload

from .api.fit import Arms, Elastic
from .api.predict_compare import Records
from .api.read_save import How, Place
from .base.units import Quantity, Range
from .datamodel.fit import Fit
from .datamodel.frf import FRF
from .datamodel.machine import Machine
from .datamodel.relaxation import RampHold, RelaxationTest
from .datamodel.structure import FRFSet as FRFSet
from .datamodel.vibration_tests import ImpactTest as ImpactTest
from .datamodel.vibration_tests import ShakenTest as ShakenTest
from .extensions.amplitude.datamodel import AmplitudeFit, AmplitudeSweep
from .extensions.amplitude.fit_files import AmplitudeResult
from .extensions.batch.comparison import LotComparison
from .extensions.batch.lot import Lot
from .extensions.curves.datamodel.creep import CreepCompliance, CreepTest, LoadHold
from .extensions.curves.datamodel.dynamic import DynamicTest
from .extensions.curves.datamodel.modulus import RelaxationModulus
from .extensions.materials.cld.datamodel import CLDTest
from .extensions.materials.cld.fit_files import CLDResult
from .extensions.materials.csr.datamodel import Aging, CSRTest
from .extensions.materials.csr.lifetime_prediction import Aged
from .extensions.materials.hyperelastic.datamodel import HyperelasticFit, StressStrainTest
from .extensions.materials.indentation.datamodel import IndentationFit, IndentationTest
from .extensions.materials.slam.datamodel import SlamFit, SlamTest
from .extensions.materials.slam.prediction import Slam
from .extensions.modes.mass_series_files import MassSeriesModes
from .extensions.systems.door.closing_result import ClosingResult
from .extensions.systems.door.door_model import Door
from .extensions.systems.door.result import DoorResult
from .fitting.identification.prior_knowledge import HammerRig, KnownSolid
from .solids.maxwell import Solid
from .solids.part_geometry import Block, Disc, Geometry
from .vibration.comparison.comparison import Comparison
from .workflow.frf_comparison import FRFComparison as FRFComparison
from .workflow.frf_prediction import Prediction as Prediction
from .workflow.job import Cuts, HammerChoices
from .workflow.measured_frf import Modes as Modes

Vibration: TypeAlias = ImpactTest | ShakenTest | FRF | FRFSet
OnBench: TypeAlias = (
    RelaxationTest
    | RampHold
    | CreepTest
    | LoadHold
    | CreepCompliance
    | DynamicTest
    | RelaxationModulus
)

@overload
def fit(
    first: Vibration,
    second: Vibration,
    /,
    *more: Vibration,
    levels: Sequence[Quantity],
    mass: Quantity | None = ...,
    seals: float = ...,
    band: Range | None = ...,
    resonance_at: Sequence[Quantity] = ...,
) -> AmplitudeResult: ...
@overload
def fit(
    record: Vibration,
    /,
    *,
    mass: Quantity,
    density: Quantity,
    shape: str | Disc | Block,
    arms: Arms = ...,
    model: str = ...,
    band: Range | None = ...,
    lubricated: bool = ...,
    mass_sd: Quantity | None = ...,
    poisson: float | None = ...,
) -> Fit: ...
@overload
def fit(
    first: Vibration,
    second: Vibration,
    /,
    *more: Vibration,
    mass: list[Quantity] | tuple[Quantity, ...],
    seals: float = ...,
    band: Range | None = ...,
) -> MassSeriesModes: ...
@overload
def fit(
    first: OnBench | Vibration | Fit,
    /,
    *more: OnBench | Vibration | Fit,
    mass: Quantity,
    seals: float = ...,
    seal_mass: Quantity | None = ...,
    arms: Arms = ...,
    model: str = ...,
    band: Range | None = ...,
    compression: Quantity | None = ...,
    prior: KnownSolid | None = ...,
    rig: HammerRig | None = ...,
    machine: Machine | None = ...,
    impact_temperature: Quantity | None = ...,
    hammer: HammerChoices | None = ...,
) -> Fit: ...
@overload
def fit(
    first: Vibration,
    /,
    *more: Vibration,
    band: Range | None = ...,
    hammer: HammerChoices | None = ...,
) -> Modes: ...
@overload
def fit(
    first: OnBench,
    /,
    *more: OnBench,
    arms: Arms = ...,
    model: str = ...,
    elastic: Elastic = ...,
    method: Literal["full", "hold"] = ...,
    thorough: bool = ...,
    filter: str | None = ...,
    cuts: Cuts | None = ...,
    machine: Machine | None = ...,
    cycle: int | None = ...,
    reference: Quantity | None = ...,
    shift: str = ...,
    vertical: str = ...,
    temperature: Quantity | None = ...,
) -> Fit: ...
@overload
def fit(
    first: CLDTest,
    /,
    *more: CLDTest,
    compression: Quantity | None = ...,
    between: Range | None = ...,
    force_limits: Range | None = ...,
    memory: Fit | Sequence[Fit] = ...,
    cycle: int | None = ...,
) -> CLDResult: ...
@overload
def fit(
    first: StressStrainTest,
    /,
    *more: StressStrainTest,
    model: str = ...,
    terms: int | Literal["auto"] = ...,
    poisson: float | None = ...,
    memory: Fit | None = ...,
    stretches: tuple[float, float] | None = ...,
    temperature: Quantity | None = ...,
    cycle: int | None = ...,
) -> HyperelasticFit: ...
@overload
def fit(first: CSRTest, /, *more: CSRTest, machine: Machine | None = ...) -> Aging: ...
@overload
def fit(
    first: SlamTest,
    /,
    *more: SlamTest,
    mass: Quantity,
    slam: Quantity | Sequence[Quantity] = ...,
    memory: Fit | Sequence[Fit] = ...,
    speed_sd: float = ...,
) -> SlamFit: ...
@overload
def fit(record: IndentationTest, /, *, model: str = ...) -> IndentationFit: ...
@overload
def fit(record: AmplitudeSweep, /, *, model: str = ...) -> AmplitudeFit: ...
@overload
def predict(
    solid: Fit,
    /,
    *,
    mass: Quantity,
    seals: float = ...,
    seal_mass: Quantity | None = ...,
    band: Range = ...,
    lines: int = ...,
    quantity: str = ...,
    base: bool | str = ...,
    relative: bool = ...,
    compression: Quantity | None = ...,
    temperature: Quantity | None = ...,
    shape: str | Geometry | None = ...,
    level: Quantity | Sequence[Quantity] = ...,
    sweep: AmplitudeSweep | None = ...,
    height: Quantity | None = ...,
    record: Records = ...,
    machine: Machine | None = ...,
) -> Prediction: ...
@overload
def predict(solid: Fit, /, *, slam: Quantity, mass: Quantity, seals: float = ...) -> Slam: ...
@overload
def predict(
    solid: Solid,
    /,
    *,
    mass: Quantity,
    seals: float = ...,
    band: Range = ...,
    lines: int = ...,
    quantity: str = ...,
) -> FRF: ...
@overload
def predict(
    solid: Aging, /, *, temperature: Quantity, until: str | Sequence[str] = ...
) -> Aged: ...
@overload
def predict(solid: Aging, /, *, temperature: Quantity, until: str, new: Fit) -> Fit: ...
@overload
def predict(
    solid: Door, /, *, close: Quantity, temperature: Quantity | None = ...
) -> ClosingResult: ...
@overload
def predict(
    solid: Door, /, *, band: Range = ..., temperature: Quantity | None = ...
) -> DoorResult: ...
@overload
def compare(
    one: Fit | Prediction,
    other: Vibration,
    /,
    *,
    mass: Quantity | None = ...,
    seals: float | None = ...,
    seal_mass: Quantity | None = ...,
    band: Range | None = ...,
    compression: Quantity | None = ...,
    record: Records = ...,
    hammer: HammerChoices | None = ...,
) -> FRFComparison: ...
@overload
def compare(one: FRF, other: FRF, /, *, band: Range | None = ...) -> Comparison: ...
@overload
def compare(one: Lot, other: Lot, /, *, quantities: Sequence[str] = ...) -> LotComparison: ...
@overload
def read(path: Place, *, kind: Literal["relaxation"], **how: Unpack[How]) -> RelaxationTest: ...
@overload
def read(
    path: Place, *, kind: Literal["creep"], **how: Unpack[How]
) -> CreepTest | CreepCompliance: ...
@overload
def read(
    path: Place, *, kind: Literal["dma", "master-curve"], **how: Unpack[How]
) -> DynamicTest: ...
@overload
def read(path: Place, *, kind: Literal["modulus"], **how: Unpack[How]) -> RelaxationModulus: ...
@overload
def read(
    path: Place | Sequence[Place], *, kind: Literal["impact"], **how: Unpack[How]
) -> ImpactTest: ...
@overload
def read(path: Place, *, kind: Literal["frf", "transmissibility"], **how: Unpack[How]) -> FRF: ...
@overload
def read(path: Place, *, kind: Literal["cld"], **how: Unpack[How]) -> CLDTest: ...
@overload
def read(
    path: Place, *, kind: Literal["stress-strain"], **how: Unpack[How]
) -> StressStrainTest: ...
@overload
def read(path: Place, *, kind: Literal["csr"], **how: Unpack[How]) -> CSRTest: ...
@overload
def read(path: Place, *, kind: Literal["slam"], **how: Unpack[How]) -> SlamTest: ...
@overload
def read(path: Place, *, kind: Literal["indentation"], **how: Unpack[How]) -> IndentationTest: ...
@overload
def read(
    path: Place, *, kind: Literal["strain-sweep", "cyclic"], **how: Unpack[How]
) -> AmplitudeSweep: ...
@overload
def read(path: Place | Sequence[Place], *, kind: str | None = ..., **how: Unpack[How]) -> Any: ...
@overload
def simulate(
    what: Literal["relaxation"],
    *,
    seal: str | Fit | Solid = ...,
    depth: Quantity = ...,
    ramp: Quantity = ...,
    hold: Quantity = ...,
    rate: Quantity | None = ...,
    temperature: Quantity | None = ...,
    noise_free: bool = ...,
    seed: int = ...,
) -> RelaxationTest: ...
@overload
def simulate(
    what: Literal["creep"],
    *,
    seal: str | Fit | Solid = ...,
    load: Quantity = ...,
    ramp: Quantity = ...,
    hold: Quantity = ...,
    rate: Quantity | None = ...,
    temperature: Quantity | None = ...,
    noise_free: bool = ...,
    seed: int = ...,
) -> CreepTest: ...
@overload
def simulate(
    what: Literal["impact"],
    *,
    seal: str | Fit | Solid = ...,
    mass: Quantity | None = ...,
    seals: float = ...,
    hits: int = ...,
    hit_length: Quantity | None = ...,
    rate: Quantity | None = ...,
    temperature: Quantity | None = ...,
    noise_free: bool = ...,
    seed: int = ...,
) -> ImpactTest: ...
