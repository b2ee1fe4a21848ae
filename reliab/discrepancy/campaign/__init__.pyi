from .campaign import Channel as Channel, held_out_in_words as held_out_in_words
from .reading import campaign_folder as campaign_folder, read_campaign as read_campaign
