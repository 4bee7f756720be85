//! Statistics for anybody's samplers and estimators.
