//! Loops that the compiler makes vectors of, for AVX-512.
//!
//! `pulp` has this too (`x86-v4`), but that feature would be faer's as well.

/// Shows that the machine has these instructions.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct EightLanes(());

impl EightLanes {
    /// None where it lacks them.
    pub(in super::super) fn available() -> Option<EightLanes> {
        let has_all = std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("avx512f")
            && std::arch::is_x86_feature_detected!("avx512dq")
            && std::arch::is_x86_feature_detected!("avx512vl");
        has_all.then_some(EightLanes(()))
    }

    /// Calls a function whose loops, where they are inlined (`#[inline(always)]`), become these instructions.
    #[allow(unsafe_code)]
    #[inline(always)]
    pub(in super::super) fn dispatch<R>(self, run: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl")]
        fn with_features<R>(run: impl FnOnce() -> R) -> R {
            run()
        }
        // SAFETY: there is such a value only where the machine has these features.
        unsafe { with_features(run) }
    }
}
