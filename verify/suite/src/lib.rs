//! Our claims about our renderer, and the program `lightproof`.
