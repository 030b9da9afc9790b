//! The kernel for x86-64 with AVX-VNNI.

super::avx_dot_products::kernel_by_dot_products!(Vnni, "avx2,avxvnni", _mm256_dpbusd_avx_epi32);
