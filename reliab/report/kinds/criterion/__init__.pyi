from .report import criterion_report as criterion_report, no_criterion_report as no_criterion_report
