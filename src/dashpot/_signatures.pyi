# signatures of the public functions whose results depend on what they are given
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, TypeAlias, Unpack, overload

from .api.fit import Arms, Elastic
from .api.predict_compare import Records
from .api.read_save import Place, ReadOptionKeywords
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
from .extensions.dynamic_stiffness.prediction import StiffnessPrediction
from .extensions.materials.cld.datamodel import CLDTest
from .extensions.materials.cld.fit_files import CLDResult
from .extensions.materials.csr.datamodel import Aging, CSRTest
from .extensions.materials.csr.lifetime_prediction import AgingPrediction
from .extensions.materials.drop.datamodel import DropFit, DropTest
from .extensions.materials.drop.prediction import DropPrediction
from .extensions.materials.hyperelastic.datamodel import HyperelasticFit, StressStrainTest
from .extensions.materials.indentation.datamodel import IndentationFit, IndentationTest
from .extensions.modes.mass_series_files import MassSeriesModes
from .extensions.systems.door.closing_result import ClosingResult
from .extensions.systems.door.door_model import Door
from .extensions.systems.door.leak_result import LeakResult
from .extensions.systems.door.result import DoorResult
from .fitting.identification.prior_knowledge import HammerRig, SolidPrior
from .reading.read_options import ReadOptions
from .solids.maxwell import Solid
from .solids.part_geometry import Block, Disc, Geometry
from .vibration.comparison.comparison_result import Comparison as Comparison
from .workflow.frf_comparison import FRFComparison as FRFComparison
from .workflow.frf_prediction import Prediction as Prediction
from .workflow.job import HammerChoices, TimeLimits
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
    mass: Quantity | None = None,
    seals: float = 1.0,
    band: Range | None = None,
    resonance_at: Sequence[Quantity] = (),
) -> AmplitudeResult: ...
@overload
def fit(
    record: Vibration,
    /,
    *,
    mass: Quantity,
    density: Quantity,
    shape: str | Disc | Block,
    arms: Arms = "auto",
    model: str = "maxwell",
    band: Range | None = None,
    lubricated: bool = False,
    mass_sd: Quantity | None = None,
    poisson: float | None = None,
) -> Fit: ...
@overload
def fit(
    first: Vibration,
    second: Vibration,
    /,
    *more: Vibration,
    mass: list[Quantity] | tuple[Quantity, ...],
    seals: float = 1.0,
    band: Range | None = None,
) -> MassSeriesModes: ...
@overload
def fit(
    first: OnBench | Vibration | Fit,
    /,
    *more: OnBench | Vibration | Fit,
    mass: Quantity,
    seals: float | None = None,
    seal_mass: Quantity | None = None,
    arms: Arms = "auto",
    model: str = "maxwell",
    band: Range | None = None,
    compression: Quantity | None = None,
    prior: SolidPrior | None = None,
    rig: HammerRig | None = None,
    machine: Machine | None = None,
    impact_temperature: Quantity | None = None,
    hammer: HammerChoices | None = None,
) -> Fit: ...
@overload
def fit(
    first: Vibration,
    /,
    *more: Vibration,
    band: Range | None = None,
    hammer: HammerChoices | None = None,
) -> Modes: ...
@overload
def fit(
    first: OnBench,
    /,
    *more: OnBench,
    arms: Arms = "auto",
    model: str = "maxwell",
    elastic: Elastic = "auto",
    method: Literal["full", "hold"] = "full",
    thorough: bool = False,
    filter: str | None = None,
    time_limits: TimeLimits | None = None,
    machine: Machine | None = None,
    cycle: int | None = None,
    reference: Quantity | None = None,
    shift: str = "auto",
    vertical: str = "auto",
    temperature: Quantity | None = None,
) -> Fit: ...
@overload
def fit(
    first: CLDTest,
    /,
    *more: CLDTest,
    compression: Quantity | None = None,
    compression_limits: Range | None = None,
    force_limits: Range | None = None,
    relaxation: Fit | Sequence[Fit] = (),
    cycle: int | None = None,
) -> CLDResult: ...
@overload
def fit(
    first: StressStrainTest,
    /,
    *more: StressStrainTest,
    model: str = "auto",
    terms: int | Literal["auto"] = "auto",
    poisson: float | None = None,
    relaxation: Fit | None = None,
    stretches: tuple[float, float] | None = None,
    temperature: Quantity | None = None,
    cycle: int | None = None,
) -> HyperelasticFit: ...
@overload
def fit(first: CSRTest, /, *more: CSRTest, machine: Machine | None = None) -> Aging: ...
@overload
def fit(
    first: DropTest,
    /,
    *more: DropTest,
    mass: Quantity,
    drop: Quantity | Sequence[Quantity] = (),
    relaxation: Fit | Sequence[Fit] = (),
    speed_sd: float = 0.05,
) -> DropFit: ...
@overload
def fit(record: IndentationTest, /, *, model: str = "auto") -> IndentationFit: ...
@overload
def fit(record: AmplitudeSweep, /, *, model: str = "auto") -> AmplitudeFit: ...
@overload
def predict(
    solid: Fit,
    /,
    *,
    mass: Quantity,
    seals: float = 1.0,
    seal_mass: Quantity | None = None,
    band: Range | None = None,
    lines: int = 2001,
    quantity: str | None = None,
    base: bool | str = False,
    relative: bool = False,
    compression: Quantity | None = None,
    temperature: Quantity | None = None,
    shape: str | Geometry | None = None,
    level: Quantity | Sequence[Quantity] = (),
    sweep: AmplitudeSweep | None = None,
    height: Quantity | None = None,
    record: Records = (),
    machine: Machine | None = None,
) -> Prediction: ...
@overload
def predict(
    solid: Fit,
    /,
    *,
    frequency: Quantity | Sequence[Quantity],
    seals: float = 1.0,
    temperature: Quantity | None = None,
    records: Sequence[str | Path] = (),
    machine: Machine | None = None,
    options: ReadOptions | None = None,
) -> StiffnessPrediction: ...
@overload
def predict(
    solid: Fit, /, *, drop: Quantity, mass: Quantity, seals: float = 1.0
) -> DropPrediction: ...
@overload
def predict(
    solid: Solid,
    /,
    *,
    mass: Quantity,
    seals: float = 1.0,
    band: Range | None = None,
    lines: int = 2001,
    quantity: str = "accelerance",
) -> FRF: ...
@overload
def predict(
    solid: Aging, /, *, temperature: Quantity, until: str | Sequence[str] = ()
) -> AgingPrediction: ...
@overload
def predict(solid: Aging, /, *, temperature: Quantity, until: str, new: Fit) -> Fit: ...
@overload
def predict(
    solid: Door, /, *, close: Quantity, temperature: Quantity | None = None
) -> ClosingResult: ...
@overload
def predict(
    solid: Door, /, *, leak: Literal[True], temperature: Quantity | None = None
) -> LeakResult: ...
@overload
def predict(
    solid: Door, /, *, band: Range | None = None, temperature: Quantity | None = None
) -> DoorResult: ...
@overload
def compare(
    one: Fit | Prediction,
    other: Vibration,
    /,
    *,
    mass: Quantity | None = None,
    seals: float | None = None,
    seal_mass: Quantity | None = None,
    band: Range | None = None,
    compression: Quantity | None = None,
    record: Records = (),
    hammer: HammerChoices | None = None,
) -> FRFComparison: ...
@overload
def compare(one: FRF, other: FRF, /, *, band: Range | None = None) -> Comparison: ...
@overload
def compare(one: Lot, other: Lot, /, *, quantities: Sequence[str] = ()) -> LotComparison: ...
@overload
def read(
    path: Place, *, kind: Literal["relaxation"], **options: Unpack[ReadOptionKeywords]
) -> RelaxationTest: ...
@overload
def read(
    path: Place, *, kind: Literal["creep"], **options: Unpack[ReadOptionKeywords]
) -> CreepTest | CreepCompliance: ...
@overload
def read(
    path: Place, *, kind: Literal["dma", "master-curve"], **options: Unpack[ReadOptionKeywords]
) -> DynamicTest: ...
@overload
def read(
    path: Place, *, kind: Literal["modulus"], **options: Unpack[ReadOptionKeywords]
) -> RelaxationModulus: ...
@overload
def read(
    path: Place | Sequence[Place], *, kind: Literal["impact"], **options: Unpack[ReadOptionKeywords]
) -> ImpactTest: ...
@overload
def read(
    path: Place, *, kind: Literal["frf", "transmissibility"], **options: Unpack[ReadOptionKeywords]
) -> FRF: ...
@overload
def read(
    path: Place, *, kind: Literal["cld"], **options: Unpack[ReadOptionKeywords]
) -> CLDTest: ...
@overload
def read(
    path: Place, *, kind: Literal["stress-strain"], **options: Unpack[ReadOptionKeywords]
) -> StressStrainTest: ...
@overload
def read(
    path: Place, *, kind: Literal["csr"], **options: Unpack[ReadOptionKeywords]
) -> CSRTest: ...
@overload
def read(
    path: Place, *, kind: Literal["drop"], **options: Unpack[ReadOptionKeywords]
) -> DropTest: ...
@overload
def read(
    path: Place, *, kind: Literal["indentation"], **options: Unpack[ReadOptionKeywords]
) -> IndentationTest: ...
@overload
def read(
    path: Place, *, kind: Literal["strain-sweep", "cyclic"], **options: Unpack[ReadOptionKeywords]
) -> AmplitudeSweep: ...
@overload
def read(
    path: Place | Sequence[Place], *, kind: str | None = ..., **options: Unpack[ReadOptionKeywords]
) -> Any: ...
@overload
def simulate(
    what: Literal["relaxation"],
    *,
    seal: str | Fit | Solid = "paper",
    depth: Quantity | None = None,
    ramp: Quantity | None = None,
    hold: Quantity | None = None,
    rate: Quantity | None = None,
    temperature: Quantity | None = None,
    noise_free: bool = False,
    seed: int = 0,
) -> RelaxationTest: ...
@overload
def simulate(
    what: Literal["creep"],
    *,
    seal: str | Fit | Solid = "paper",
    load: Quantity | None = None,
    ramp: Quantity | None = None,
    hold: Quantity | None = None,
    rate: Quantity | None = None,
    temperature: Quantity | None = None,
    noise_free: bool = False,
    seed: int = 0,
) -> CreepTest: ...
@overload
def simulate(
    what: Literal["impact"],
    *,
    seal: str | Fit | Solid = "paper",
    mass: Quantity | None = None,
    seals: float | None = None,
    hits: int | None = None,
    hit_length: Quantity | None = None,
    rate: Quantity | None = None,
    temperature: Quantity | None = None,
    noise_free: bool = False,
    seed: int = 0,
) -> ImpactTest: ...
