"""The models of the JSON files that the commands write.

``docs/schemas/`` holds the JSON Schemas generated from them. A version, such as
``bayesfric.fit/1``, only ever gains keys. Numbers are SI, never NaN or infinite.
"""

from pydantic import BaseModel

from bayesfric.schemas.base import Check as Check
from bayesfric.schemas.base import Interval as Interval
from bayesfric.schemas.base import Provenance as Provenance
from bayesfric.schemas.base import Record as Record
from bayesfric.schemas.base import RecordingId as RecordingId
from bayesfric.schemas.calibration import CalibratedQuantity as CalibratedQuantity
from bayesfric.schemas.calibration import CalibrationCase as CalibrationCase
from bayesfric.schemas.calibration import CalibrationFile as CalibrationFile
from bayesfric.schemas.causes import Absorbed as Absorbed
from bayesfric.schemas.causes import Cause as Cause
from bayesfric.schemas.causes import EffectNumber as EffectNumber
from bayesfric.schemas.causes import Inclusion as Inclusion
from bayesfric.schemas.causes import LawNumber as LawNumber
from bayesfric.schemas.causes import ModelError as ModelError
from bayesfric.schemas.causes import Remainder as Remainder
from bayesfric.schemas.causes import Shape as Shape
from bayesfric.schemas.causes import Unseparated as Unseparated
from bayesfric.schemas.claims import ClaimResult as ClaimResult
from bayesfric.schemas.claims import ClaimsFile as ClaimsFile
from bayesfric.schemas.claims import PulleyEvidence as PulleyEvidence
from bayesfric.schemas.claims import SelfContradiction as SelfContradiction
from bayesfric.schemas.comparison import ComparisonFile as ComparisonFile
from bayesfric.schemas.comparison import Flip as Flip
from bayesfric.schemas.comparison import Setting as Setting
from bayesfric.schemas.comparison import Shift as Shift
from bayesfric.schemas.diagnosis import Axis as Axis
from bayesfric.schemas.diagnosis import ConditionAsked as ConditionAsked
from bayesfric.schemas.diagnosis import DiagnosisFile as DiagnosisFile
from bayesfric.schemas.diagnosis import Enter as Enter
from bayesfric.schemas.diagnosis import ExaminedEffect as ExaminedEffect
from bayesfric.schemas.diagnosis import FrictionAsked as FrictionAsked
from bayesfric.schemas.diagnosis import Gap as Gap
from bayesfric.schemas.diagnosis import GapRow as GapRow
from bayesfric.schemas.diagnosis import HeldOutDensity as HeldOutDensity
from bayesfric.schemas.diagnosis import NextExperiment as NextExperiment
from bayesfric.schemas.diagnosis import Replay as Replay
from bayesfric.schemas.diagnosis import ReplayedError as ReplayedError
from bayesfric.schemas.diagnosis import SimulatorField as SimulatorField
from bayesfric.schemas.diagnosis import SimulatorUsed as SimulatorUsed
from bayesfric.schemas.fit import Agreement as Agreement
from bayesfric.schemas.fit import AssemblyCheck as AssemblyCheck
from bayesfric.schemas.fit import Clocks as Clocks
from bayesfric.schemas.fit import DataQuality as DataQuality
from bayesfric.schemas.fit import Excluded as Excluded
from bayesfric.schemas.fit import FitFile as FitFile
from bayesfric.schemas.fit import JointFit as JointFit
from bayesfric.schemas.fit import OutlyingAssembly as OutlyingAssembly
from bayesfric.schemas.fit import PointEstimate as PointEstimate
from bayesfric.schemas.fit import Prediction as Prediction
from bayesfric.schemas.fit import Repaired as Repaired
from bayesfric.schemas.fit import SamplerSummary as SamplerSummary
from bayesfric.schemas.fit import TimingsFile as TimingsFile
from bayesfric.schemas.fit import Uniformity as Uniformity
from bayesfric.schemas.fit import WithoutExclusions as WithoutExclusions
from bayesfric.schemas.instrument import Instrument as Instrument
from bayesfric.schemas.instrument import InstrumentNumber as InstrumentNumber
from bayesfric.schemas.margins import Bode as Bode
from bayesfric.schemas.margins import Certificate as Certificate
from bayesfric.schemas.margins import Compensator as Compensator
from bayesfric.schemas.margins import FollowedWith as FollowedWith
from bayesfric.schemas.margins import Following as Following
from bayesfric.schemas.margins import GammaProbability as GammaProbability
from bayesfric.schemas.margins import Held as Held
from bayesfric.schemas.margins import HuntingMap as HuntingMap
from bayesfric.schemas.margins import LawUsed as LawUsed
from bayesfric.schemas.margins import LoopMargins as LoopMargins
from bayesfric.schemas.margins import MarginsFile as MarginsFile
from bayesfric.schemas.margins import Metric as Metric
from bayesfric.schemas.margins import NyquistFan as NyquistFan
from bayesfric.schemas.margins import Plant as Plant
from bayesfric.schemas.margins import Trajectory as Trajectory
from bayesfric.schemas.margins import Tuning as Tuning
from bayesfric.schemas.margins import Verification as Verification
from bayesfric.schemas.margins import VerifiedDraw as VerifiedDraw
from bayesfric.schemas.margins import WithEffects as WithEffects
from bayesfric.schemas.parameter import ParameterSummary as ParameterSummary
from bayesfric.schemas.parameter import StoredDraws as StoredDraws
from bayesfric.schemas.pooled import BoardCoefficient as BoardCoefficient
from bayesfric.schemas.pooled import Pooled as Pooled
from bayesfric.schemas.pooled import PooledBoard as PooledBoard
from bayesfric.schemas.pooled import PooledCoefficient as PooledCoefficient
from bayesfric.schemas.scorecard import Confusion as Confusion
from bayesfric.schemas.scorecard import Detected as Detected
from bayesfric.schemas.scorecard import Estimate as Estimate
from bayesfric.schemas.scorecard import Oracle as Oracle
from bayesfric.schemas.scorecard import Rate as Rate
from bayesfric.schemas.scorecard import ReliabilityBin as ReliabilityBin
from bayesfric.schemas.scorecard import ScorecardFile as ScorecardFile
from bayesfric.schemas.scorecard import ScoredCase as ScoredCase
from bayesfric.schemas.scorecard import Target as Target

SCHEMAS: dict[str, type[BaseModel]] = {
    "fit": FitFile,
    "claims": ClaimsFile,
    "diagnosis": DiagnosisFile,
    "scorecard": ScorecardFile,
    "margins": MarginsFile,
    "calibration": CalibrationFile,
    "timings": TimingsFile,
    "comparison": ComparisonFile,
}
"""The models by the name of the file that they describe."""
