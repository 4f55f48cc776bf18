"""Who demonstrates.

phase.py      our scripted experts, and the table of all experts
metaworld.py  Meta-World's own policies, in the object's frame
"""
