from .frame import frame_assessment_report as frame_assessment_report
from .report import assessment_report as assessment_report
