from .campaign import Channel as Channel
from .reading import campaign_folder as campaign_folder, read_campaign as read_campaign
