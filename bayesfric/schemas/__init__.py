"""The models of the JSON files that the commands write.

``docs/schemas/`` holds the JSON Schemas generated from them. A version, such as
``bayesfric.fit/1``, only ever gains keys. Numbers are SI, never NaN or infinite.
"""

from pydantic import BaseModel

from bayesfric.schemas.base import Interval, Provenance, RecordingId
from bayesfric.schemas.claims import (
    ClaimResult,
    ClaimsFile,
    PulleyEvidence,
    SelfContradiction,
)
from bayesfric.schemas.diagnosis import (
    Absorbed,
    Axis,
    Cause,
    DiagnosisFile,
    EffectNumber,
    ExaminedEffect,
    Gap,
    GapRow,
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
    Repaired,
    SamplerSummary,
    TimingsFile,
    WithoutExclusions,
)
from bayesfric.schemas.margins import (
    GammaProbability,
    LoopMargins,
    MarginsFile,
    Metric,
    NyquistFan,
    Verification,
    VerifiedDraw,
    WithEffects,
)

__all__ = [
    "SCHEMAS",
    "Absorbed",
    "Agreement",
    "Axis",
    "Cause",
    "ClaimResult",
    "ClaimsFile",
    "DataQuality",
    "DiagnosisFile",
    "EffectNumber",
    "ExaminedEffect",
    "Excluded",
    "FitFile",
    "GammaProbability",
    "Gap",
    "GapRow",
    "Interval",
    "LoopMargins",
    "MarginsFile",
    "Metric",
    "NextExperiment",
    "NyquistFan",
    "ParameterSummary",
    "PointEstimate",
    "Provenance",
    "PulleyEvidence",
    "RecordingId",
    "Remainder",
    "Repaired",
    "SamplerSummary",
    "SelfContradiction",
    "Shape",
    "TimingsFile",
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
    "margins": MarginsFile,
    "timings": TimingsFile,
}
"""The models by the name of the file that they describe."""
