//! The kernel for x86-64 with AVX512-VNNI, on vectors of 256 bits.

super::avx_dot_products::kernel_by_dot_products!(
    Avx512,
    "avx2,avx512f,avx512vl,avx512vnni",
    _mm256_dpbusd_epi32
);
