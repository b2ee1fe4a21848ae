from .campaign import Channel as Channel
from .folder import campaign_folder as campaign_folder
from .reading import read_campaign as read_campaign
