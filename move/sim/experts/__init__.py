"""Who demonstrates.

phase.py      our scripted experts, and the table of all experts
transport.py  where a held object goes next, task by task
metaworld.py  Meta-World's own policies, in the object's frame
"""
