def check_campaign(c): pass
