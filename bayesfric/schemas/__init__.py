"""The models of the JSON files that the commands write.

``docs/schemas/`` holds the JSON Schemas generated from them. A version, such as
``bayesfric.fit/1``, only ever gains keys. Numbers are SI, never NaN or infinite.
"""

from pydantic import BaseModel

from bayesfric.schemas.base import Interval, Provenance, RecordingId
from bayesfric.schemas.calibration import (
    CalibratedQuantity,
    CalibrationCase,
    CalibrationFile,
)
from bayesfric.schemas.claims import (
    ClaimResult,
    ClaimsFile,
    PulleyEvidence,
    SelfContradiction,
)
from bayesfric.schemas.comparison import ComparisonFile, Flip, Setting, Shift
from bayesfric.schemas.diagnosis import (
    Absorbed,
    Axis,
    Cause,
    DiagnosisFile,
    EffectNumber,
    ExaminedEffect,
    Gap,
    GapRow,
    Inclusion,
    NextExperiment,
    Remainder,
    Shape,
    Unseparated,
)
from bayesfric.schemas.fit import (
    Agreement,
    DataQuality,
    Excluded,
    FitFile,
    ParameterSummary,
    PointEstimate,
    Prediction,
    Repaired,
    SamplerSummary,
    TimingsFile,
    Uniformity,
    WithoutExclusions,
)
from bayesfric.schemas.margins import (
    GammaProbability,
    Held,
    HuntingMap,
    LoopMargins,
    MarginsFile,
    Metric,
    NyquistFan,
    Tuning,
    Verification,
    VerifiedDraw,
    WithEffects,
)
from bayesfric.schemas.scorecard import (
    Confusion,
    Detected,
    Estimate,
    Oracle,
    Rate,
    ReliabilityBin,
    ScorecardFile,
    ScoredCase,
    Target,
)

__all__ = [
    "SCHEMAS",
    "Absorbed",
    "Agreement",
    "Axis",
    "CalibratedQuantity",
    "CalibrationCase",
    "CalibrationFile",
    "Cause",
    "ClaimResult",
    "ClaimsFile",
    "ComparisonFile",
    "Confusion",
    "DataQuality",
    "Detected",
    "DiagnosisFile",
    "EffectNumber",
    "Estimate",
    "ExaminedEffect",
    "Excluded",
    "FitFile",
    "Flip",
    "GammaProbability",
    "Gap",
    "GapRow",
    "Held",
    "HuntingMap",
    "Inclusion",
    "Interval",
    "LoopMargins",
    "MarginsFile",
    "Metric",
    "NextExperiment",
    "NyquistFan",
    "Oracle",
    "ParameterSummary",
    "PointEstimate",
    "Prediction",
    "Provenance",
    "PulleyEvidence",
    "Rate",
    "RecordingId",
    "ReliabilityBin",
    "Remainder",
    "Repaired",
    "SamplerSummary",
    "ScorecardFile",
    "ScoredCase",
    "SelfContradiction",
    "Setting",
    "Shape",
    "Shift",
    "Target",
    "TimingsFile",
    "Tuning",
    "Uniformity",
    "Unseparated",
    "Verification",
    "VerifiedDraw",
    "WithEffects",
    "WithoutExclusions",
]

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
