from .refusal import no_criterion_report as no_criterion_report
from .report import criterion_report as criterion_report
