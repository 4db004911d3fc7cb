"""The models of the JSON files that the commands write.

``docs/schemas/`` holds the JSON Schemas generated from them. A schema, such as
``bayesfric.fit/1``, only gains keys. Numbers are SI, never NaN or infinite.
"""

from pydantic import BaseModel

from bayesfric.schemas.calibration import CalibrationFile as CalibrationFile
from bayesfric.schemas.claims import ClaimsFile as ClaimsFile
from bayesfric.schemas.comparison import ComparisonFile as ComparisonFile
from bayesfric.schemas.diagnosis import DiagnosisFile as DiagnosisFile
from bayesfric.schemas.fit import FitFile as FitFile
from bayesfric.schemas.fit import TimingsFile as TimingsFile
from bayesfric.schemas.margins import MarginsFile as MarginsFile
from bayesfric.schemas.scorecard import ScorecardFile as ScorecardFile

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
"""The models, by the name of the file that they describe."""
