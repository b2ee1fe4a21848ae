from .critical_delay import (
    StabilityLimit as StabilityLimit,
    stability_limit as stability_limit,
)
from .frames.frame import condensed as condensed, static_shapes as static_shapes
from .partition import (
    Partition as Partition,
    whole_structure as whole_structure,
)
from .parts_of_structure import (
    PARTS as PARTS,
    is_of_entries as is_of_entries,
    is_part as is_part,
    least_of as least_of,
    name_of_entries as name_of_entries,
    part_and_number as part_and_number,
    with_parts as with_parts,
)
from .specimen import (
    Specimen as Specimen,
    drift_interface as drift_interface,
    floor_interface as floor_interface,
    with_specimen as with_specimen,
)
from .stability import (
    longest_lead as longest_lead,
    refuse_long_leads as refuse_long_leads,
    stability_margin as stability_margin,
)
from .structure import Structure as Structure
