//! Shapes, walls, the periodic cell and neighbour search
