//! Physical dimensions and quantities with units: text to SI numbers
