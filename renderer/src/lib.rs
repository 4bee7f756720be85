//! A distribution ray tracer.
