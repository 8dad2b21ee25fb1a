"""lines -> hits -> tally"""
