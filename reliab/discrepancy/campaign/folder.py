"""Where a campaign lies: in the folder that is named, or among what ships."""

from pathlib import Path

from reliab.shipped import shipped

CAMPAIGN_FILE = "campaign.toml"


def campaign_folder(folder: Path | str) -> Path:
    """Take the path of a campaign as it is, or as the name of one that ships where there is no such path.

    Parameters
    ----------
    folder : path
        A path, or a name such as ``rig_a``.

    Returns
    -------
    pathlib.Path
        The path, or that of the campaign that ships.

    Examples
    --------
    >>> campaign_folder("rig_a").parts[-2:]
    ('campaigns', 'rig_a')
    """
    folder = Path(folder)
    named = shipped("datasets", "campaigns") / folder
    is_name = len(folder.parts) == 1 and not folder.exists()
    return named if is_name and (named / CAMPAIGN_FILE).is_file() else folder
