"""Where does a particle leave a patch it hit?"""

EQUATIONS = ("discrete",)
