def figure3(): return ""
def figure4(): return ""
