"""The machine as a diagnosis sees it: parameters in, channels out, on the analysis grid."""
