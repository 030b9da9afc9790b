0000000000152650 <posewise::shape::linear::System::set>:
  152650:	push   %rbp
  152651:	push   %r15
  152653:	push   %r14
  152655:	push   %r13
  152657:	push   %r12
  152659:	push   %rbx
  15265a:	sub    $0x238,%rsp
  152661:	mov    %rsi,%r14
  152664:	mov    %rdi,%rbx
  152667:	mov    $0xf90,%edx
  15266c:	xor    %esi,%esi
  15266e:	call   *0x7e62c(%rip)        # 1d0ca0 <memset@GLIBC_2.2.5>
  152674:	mov    (%r14),%r15
  152677:	mov    %r14,0x10(%rsp)
  15267c:	mov    0x18(%r14),%r14
  152680:	lea    0xe0(%r14),%rcx
  152687:	mov    0x60(%r15),%rsi
  15268b:	mov    0x68(%r15),%rdx
  15268f:	lea    0x1b0(%rsp),%rdi
  152697:	call   14c7d0 <posewise::shape::face::contour_directions>
  15269c:	mov    %r15,0x8(%rsp)
  1526a1:	mov    0x78(%r15),%rax
  1526a5:	cmp    $0x44,%rax
  1526a9:	mov    $0x44,%r12d
  1526af:	cmovb  %rax,%r12
  1526b3:	test   %rax,%rax
  1526b6:	je     152dac <posewise::shape::linear::System::set+0x75c>
  1526bc:	mov    0x10(%rsp),%rax
  1526c1:	mov    0x10(%rax),%rax
  1526c5:	mov    (%rax),%r8
  1526c8:	mov    0x8(%rax),%r10
  1526cc:	mov    0x8(%rsp),%rax
  1526d1:	mov    0x70(%rax),%rax
  1526d5:	mov    %rax,0x148(%rsp)
  1526dd:	lea    0xb0(%rsp),%r15
  1526e5:	mov    $0x7fffffff,%r9d
  1526eb:	xor    %ebp,%ebp
  1526ed:	mov    %r8,0x150(%rsp)
  1526f5:	mov    %r10,0x140(%rsp)
  1526fd:	jmp    15278c <posewise::shape::linear::System::set+0x13c>
  152702:	movaps %xmm1,%xmm3
  152705:	mulss  %xmm2,%xmm3
  152709:	mulss  %xmm2,%xmm3
  15270d:	addss  0xf88(%rbx),%xmm3
  152715:	movss  0x1a8(%rsp),%xmm4
  15271e:	movss  0x1ac(%rsp),%xmm5
  152727:	movss  %xmm4,%xmm2
  15272b:	mulps  %xmm2,%xmm0
  15272e:	mulps  %xmm2,%xmm0
  152731:	movups 0xf80(%rbx),%xmm2
  152738:	unpcklps %xmm1,%xmm3
  15273b:	movlhps %xmm3,%xmm2
  15273e:	movlhps %xmm0,%xmm5
  152741:	movss  0xf8c(%rbx),%xmm1
  152749:	shufps $0xd4,%xmm0,%xmm1
  15274d:	shufps $0x28,%xmm1,%xmm5
  152751:	addps  %xmm2,%xmm5
  152754:	movups %xmm5,0xf80(%rbx)
  15275b:	incq   0xf78(%rbx)
  152762:	mov    0x150(%rsp),%r8
  15276a:	mov    $0x7fffffff,%r9d
  152770:	mov    0x140(%rsp),%r10
  152778:	nopl   0x0(%rax,%rax,1)
  152780:	inc    %rbp
  152783:	cmp    %r12,%rbp
  152786:	je     152dac <posewise::shape::linear::System::set+0x75c>
  15278c:	movd   (%r10,%rbp,4),%xmm0
  152792:	movd   %xmm0,%eax
  152796:	test   %eax,%eax
  152798:	sets   %cl
  15279b:	and    $0x7fffffff,%eax
  1527a0:	lea    -0x800000(%rax),%edx
  1527a6:	cmp    $0x7f000000,%edx
  1527ac:	setb   %dl
  1527af:	and    %cl,%dl
  1527b1:	lea    -0x1(%rax),%esi
  1527b4:	cmp    $0x7fffff,%esi
  1527ba:	setb   %sil
  1527be:	and    %cl,%sil
  1527c1:	test   %eax,%eax
  1527c3:	sete   %cl
  1527c6:	cmp    $0x7f800000,%eax
  1527cb:	sete   %dil
  1527cf:	or     %cl,%dil
  1527d2:	cmp    $0x7f800001,%eax
  1527d7:	setge  %al
  1527da:	or     %dil,%al
  1527dd:	or     %sil,%al
  1527e0:	or     %dl,%al
  1527e2:	jne    152780 <posewise::shape::linear::System::set+0x130>
  1527e4:	mov    (%r8,%rbp,8),%eax
  1527e8:	and    %r9d,%eax
  1527eb:	cmp    $0x7f800000,%eax
  1527f0:	jge    152780 <posewise::shape::linear::System::set+0x130>
  1527f2:	mov    0x4(%r8,%rbp,8),%eax
  1527f7:	and    %r9d,%eax
  1527fa:	cmp    $0x7f7fffff,%eax
  1527ff:	jg     152780 <posewise::shape::linear::System::set+0x130>
  152805:	mov    (%r8,%rbp,8),%rax
  152809:	mov    0x148(%rsp),%rcx
  152811:	movss  (%rcx,%rbp,4),%xmm1
  152816:	mov    %rbp,0x18(%rsp)
  15281b:	mov    %rax,0x20(%rsp)
  152820:	movd   %xmm0,0x28(%rsp)
  152826:	movss  %xmm1,0x2c(%rsp)
  15282c:	cmp    $0x11,%rbp
  152830:	lea    0x1b0(%rsp,%rbp,8),%rcx
  152838:	mov    $0x0,%eax
  15283d:	cmovae %rax,%rcx
  152841:	lea    0x158(%rsp),%r13
  152849:	mov    %r13,%rdi
  15284c:	mov    0x10(%rsp),%rsi
  152851:	lea    0x18(%rsp),%rdx
  152856:	call   153900 <posewise::shape::linear::Residuals::row>
  15285b:	lea    0x30(%rsp),%rdi
  152860:	mov    0x8(%rsp),%rsi
  152865:	mov    %r13,%rdx
  152868:	call   153190 <posewise::shape::linear::Gradients::new>
  15286d:	movss  0x198(%rsp),%xmm1
  152876:	movsd  0x160(%rsp),%xmm2
  15287f:	movaps %xmm2,%xmm3
  152882:	shufps $0x55,%xmm2,%xmm3
  152886:	movaps %xmm2,%xmm4
  152889:	shufps $0x0,%xmm2,%xmm4
  15288d:	movaps %xmm1,%xmm0
  152890:	shufps $0x0,%xmm1,%xmm0
  152894:	movaps 0x30(%rsp),%xmm5
  152899:	mulps  %xmm0,%xmm5
  15289c:	movaps 0x40(%rsp),%xmm6
  1528a1:	mulps  %xmm0,%xmm6
  1528a4:	movaps 0xb0(%rsp),%xmm7
  1528ac:	mulps  %xmm0,%xmm7
  1528af:	movaps 0xc0(%rsp),%xmm8
  1528b8:	mulps  %xmm0,%xmm8
  1528bc:	mulps  %xmm4,%xmm5
  1528bf:	mulps  %xmm4,%xmm6
  1528c2:	movups 0xf00(%rbx),%xmm9
  1528ca:	addps  %xmm5,%xmm9
  1528ce:	movups 0xf10(%rbx),%xmm5
  1528d5:	addps  %xmm6,%xmm5
  1528d8:	movups 0xf20(%rbx),%xmm6
  1528df:	movups 0xf30(%rbx),%xmm10
  1528e7:	mulps  %xmm3,%xmm7
  1528ea:	addps  %xmm9,%xmm7
  1528ee:	mulps  %xmm3,%xmm8
  1528f2:	addps  %xmm5,%xmm8
  1528f6:	movups %xmm7,0xf00(%rbx)
  1528fd:	movups %xmm8,0xf10(%rbx)
  152905:	movaps 0x50(%rsp),%xmm5
  15290a:	mulps  %xmm0,%xmm5
  15290d:	movaps 0x60(%rsp),%xmm7
  152912:	mulps  %xmm0,%xmm7
  152915:	movaps 0xd0(%rsp),%xmm8
  15291e:	mulps  %xmm0,%xmm8
  152922:	movaps 0xe0(%rsp),%xmm9
  15292b:	mulps  %xmm0,%xmm9
  15292f:	mulps  %xmm4,%xmm5
  152932:	addps  %xmm6,%xmm5
  152935:	mulps  %xmm4,%xmm7
  152938:	addps  %xmm10,%xmm7
  15293c:	mulps  %xmm3,%xmm8
  152940:	addps  %xmm5,%xmm8
  152944:	mulps  %xmm3,%xmm9
  152948:	addps  %xmm7,%xmm9
  15294c:	movups %xmm8,0xf20(%rbx)
  152954:	movups %xmm9,0xf30(%rbx)
  15295c:	movaps 0x70(%rsp),%xmm5
  152961:	mulps  %xmm0,%xmm5
  152964:	movaps 0x80(%rsp),%xmm6
  15296c:	mulps  %xmm0,%xmm6
  15296f:	movaps 0xf0(%rsp),%xmm7
  152977:	mulps  %xmm0,%xmm7
  15297a:	movaps 0x100(%rsp),%xmm8
  152983:	mulps  %xmm0,%xmm8
  152987:	mulps  %xmm4,%xmm5
  15298a:	mulps  %xmm4,%xmm6
  15298d:	movups 0xf40(%rbx),%xmm4
  152994:	addps  %xmm5,%xmm4
  152997:	movups 0xf50(%rbx),%xmm5
  15299e:	addps  %xmm6,%xmm5
  1529a1:	mulps  %xmm3,%xmm7
  1529a4:	addps  %xmm4,%xmm7
  1529a7:	mulps  %xmm3,%xmm8
  1529ab:	addps  %xmm5,%xmm8
  1529af:	movups %xmm7,0xf40(%rbx)
  1529b6:	movups %xmm8,0xf50(%rbx)
  1529be:	movss  0x90(%rsp),%xmm3
  1529c7:	movss  0x110(%rsp),%xmm4
  1529d0:	unpcklps %xmm4,%xmm3
  1529d3:	mulps  %xmm0,%xmm3
  1529d6:	mulps  %xmm2,%xmm3
  1529d9:	movss  0xf60(%rbx),%xmm4
  1529e1:	addss  %xmm3,%xmm4
  1529e5:	shufps $0x55,%xmm3,%xmm3
  1529e9:	addss  %xmm4,%xmm3
  1529ed:	movss  %xmm3,0xf60(%rbx)
  1529f5:	movss  0x94(%rsp),%xmm3
  1529fe:	movss  0x114(%rsp),%xmm4
  152a07:	unpcklps %xmm4,%xmm3
  152a0a:	mulps  %xmm0,%xmm3
  152a0d:	mulps  %xmm2,%xmm3
  152a10:	movss  0xf64(%rbx),%xmm4
  152a18:	addss  %xmm3,%xmm4
  152a1c:	shufps $0x55,%xmm3,%xmm3
  152a20:	addss  %xmm4,%xmm3
  152a24:	movss  %xmm3,0xf64(%rbx)
  152a2c:	movss  0x98(%rsp),%xmm3
  152a35:	movss  0x118(%rsp),%xmm4
  152a3e:	unpcklps %xmm4,%xmm3
  152a41:	mulps  %xmm0,%xmm3
  152a44:	mulps  %xmm2,%xmm3
  152a47:	movss  0xf68(%rbx),%xmm4
  152a4f:	addss  %xmm3,%xmm4
  152a53:	shufps $0x55,%xmm3,%xmm3
  152a57:	addss  %xmm4,%xmm3
  152a5b:	movss  %xmm3,0xf68(%rbx)
  152a63:	movss  0x9c(%rsp),%xmm3
  152a6c:	movss  0x11c(%rsp),%xmm4
  152a75:	unpcklps %xmm4,%xmm3
  152a78:	mulps  %xmm0,%xmm3
  152a7b:	mulps  %xmm2,%xmm3
  152a7e:	movss  0xf6c(%rbx),%xmm4
  152a86:	addss  %xmm3,%xmm4
  152a8a:	shufps $0x55,%xmm3,%xmm3
  152a8e:	addss  %xmm4,%xmm3
  152a92:	movss  %xmm3,0xf6c(%rbx)
  152a9a:	movss  0xa0(%rsp),%xmm3
  152aa3:	movss  0x120(%rsp),%xmm4
  152aac:	unpcklps %xmm4,%xmm3
  152aaf:	mulps  %xmm0,%xmm3
  152ab2:	mulps  %xmm2,%xmm3
  152ab5:	movss  0xf70(%rbx),%xmm4
  152abd:	addss  %xmm3,%xmm4
  152ac1:	shufps $0x55,%xmm3,%xmm3
  152ac5:	addss  %xmm4,%xmm3
  152ac9:	movss  %xmm3,0xf70(%rbx)
  152ad1:	movss  0xa4(%rsp),%xmm3
  152ada:	movss  0x124(%rsp),%xmm4
  152ae3:	unpcklps %xmm4,%xmm3
  152ae6:	mulps  %xmm0,%xmm3
  152ae9:	mulps  %xmm2,%xmm3
  152aec:	movss  0xf74(%rbx),%xmm4
  152af4:	addss  %xmm3,%xmm4
  152af8:	shufps $0x55,%xmm3,%xmm3
  152afc:	addss  %xmm4,%xmm3
  152b00:	mov    0x138(%rsp),%rax
  152b08:	cmp    $0x9,%rax
  152b0c:	mov    $0x1,%ecx
  152b11:	lea    0x130(%rsp),%rdx
  152b19:	cmovb  %rdx,%rcx
  152b1d:	movss  %xmm3,0xf74(%rbx)
  152b25:	mov    $0x0,%edx
  152b2a:	cmovae %rdx,%rax
  152b2e:	test   %rax,%rax
  152b31:	je     152702 <posewise::shape::linear::System::set+0xb2>
  152b37:	add    %rcx,%rax
  152b3a:	xor    %edx,%edx
  152b3c:	mov    %rcx,%rsi
  152b3f:	jmp    152b5f <posewise::shape::linear::System::set+0x50f>
  152b41:	data16 data16 data16 data16 data16 cs nopw 0x0(%rax,%rax,1)
  152b50:	inc    %rsi
  152b53:	inc    %rdx
  152b56:	cmp    %rax,%rsi
  152b59:	je     152702 <posewise::shape::linear::System::set+0xb2>
  152b5f:	movzbl (%rsi),%edi
  152b62:	test   %edi,%edi
  152b64:	jne    152d6c <posewise::shape::linear::System::set+0x71c>
  152b6a:	mov    $0x1,%edi
  152b6f:	xor    %r8d,%r8d
  152b72:	movss  0x30(%rsp,%r8,4),%xmm3
  152b79:	mulss  %xmm1,%xmm3
  152b7d:	movss  0xb0(%rsp,%r8,4),%xmm4
  152b87:	mulss  %xmm1,%xmm4
  152b8b:	shl    $0x7,%r8
  152b8f:	add    %rbx,%r8
  152b92:	shufps $0x0,%xmm3,%xmm3
  152b96:	shufps $0x0,%xmm4,%xmm4
  152b9a:	mov    $0xffffffffffffffff,%r9
  152ba1:	data16 data16 data16 data16 data16 cs nopw 0x0(%rax,%rax,1)
  152bb0:	movzbl 0x1(%rcx,%r9,1),%r10d
  152bb6:	and    $0x7,%r10d
  152bba:	shl    $0x4,%r10d
  152bbe:	movups (%r8,%r10,1),%xmm5
  152bc3:	movaps 0x30(%rsp,%r10,1),%xmm6
  152bc9:	mulps  %xmm3,%xmm6
  152bcc:	addps  %xmm5,%xmm6
  152bcf:	movaps (%r15,%r10,1),%xmm5
  152bd4:	mulps  %xmm4,%xmm5
  152bd7:	addps  %xmm6,%xmm5
  152bda:	movups %xmm5,(%r8,%r10,1)
  152bdf:	inc    %r9
  152be2:	cmp    %r9,%rdx
  152be5:	jne    152bb0 <posewise::shape::linear::System::set+0x560>
  152be7:	cmp    $0x1d,%rdi
  152beb:	ja     152b50 <posewise::shape::linear::System::set+0x500>
  152bf1:	movss  0x30(%rsp,%rdi,4),%xmm3
  152bf7:	mulss  %xmm1,%xmm3
  152bfb:	movss  0xb0(%rsp,%rdi,4),%xmm4
  152c04:	mulss  %xmm1,%xmm4
  152c08:	mov    %rdi,%r8
  152c0b:	shl    $0x7,%r8
  152c0f:	add    %rbx,%r8
  152c12:	shufps $0x0,%xmm3,%xmm3
  152c16:	shufps $0x0,%xmm4,%xmm4
  152c1a:	mov    $0xffffffffffffffff,%r9
  152c21:	data16 data16 data16 data16 data16 cs nopw 0x0(%rax,%rax,1)
  152c30:	movzbl 0x1(%rcx,%r9,1),%r10d
  152c36:	and    $0x7,%r10d
  152c3a:	shl    $0x4,%r10d
  152c3e:	movups (%r8,%r10,1),%xmm5
  152c43:	movaps 0x30(%rsp,%r10,1),%xmm6
  152c49:	mulps  %xmm3,%xmm6
  152c4c:	addps  %xmm5,%xmm6
  152c4f:	movaps (%r15,%r10,1),%xmm5
  152c54:	mulps  %xmm4,%xmm5
  152c57:	addps  %xmm6,%xmm5
  152c5a:	movups %xmm5,(%r8,%r10,1)
  152c5f:	inc    %r9
  152c62:	cmp    %r9,%rdx
  152c65:	jne    152c30 <posewise::shape::linear::System::set+0x5e0>
  152c67:	cmp    $0x1d,%rdi
  152c6b:	je     152b50 <posewise::shape::linear::System::set+0x500>
  152c71:	lea    0x1(%rdi),%r8
  152c75:	movss  0x34(%rsp,%rdi,4),%xmm3
  152c7b:	mulss  %xmm1,%xmm3
  152c7f:	movss  0xb4(%rsp,%rdi,4),%xmm4
  152c88:	mulss  %xmm1,%xmm4
  152c8c:	shl    $0x7,%r8
  152c90:	add    %rbx,%r8
  152c93:	shufps $0x0,%xmm3,%xmm3
  152c97:	shufps $0x0,%xmm4,%xmm4
  152c9b:	mov    $0xffffffffffffffff,%r9
  152ca2:	data16 data16 data16 data16 cs nopw 0x0(%rax,%rax,1)
  152cb0:	movzbl 0x1(%rcx,%r9,1),%r10d
  152cb6:	and    $0x7,%r10d
  152cba:	shl    $0x4,%r10d
  152cbe:	movups (%r8,%r10,1),%xmm5
  152cc3:	movaps 0x30(%rsp,%r10,1),%xmm6
  152cc9:	mulps  %xmm3,%xmm6
  152ccc:	addps  %xmm5,%xmm6
  152ccf:	movaps (%r15,%r10,1),%xmm5
  152cd4:	mulps  %xmm4,%xmm5
  152cd7:	addps  %xmm6,%xmm5
  152cda:	movups %xmm5,(%r8,%r10,1)
  152cdf:	inc    %r9
  152ce2:	cmp    %r9,%rdx
  152ce5:	jne    152cb0 <posewise::shape::linear::System::set+0x660>
  152ce7:	cmp    $0x1b,%rdi
  152ceb:	ja     152b50 <posewise::shape::linear::System::set+0x500>
  152cf1:	lea    0x2(%rdi),%r8
  152cf5:	movss  0x38(%rsp,%rdi,4),%xmm3
  152cfb:	mulss  %xmm1,%xmm3
  152cff:	movss  0xb8(%rsp,%rdi,4),%xmm4
  152d08:	mulss  %xmm1,%xmm4
  152d0c:	shl    $0x7,%r8
  152d10:	add    %rbx,%r8
  152d13:	shufps $0x0,%xmm3,%xmm3
  152d17:	shufps $0x0,%xmm4,%xmm4
  152d1b:	mov    $0xffffffffffffffff,%rdi
  152d22:	data16 data16 data16 data16 cs nopw 0x0(%rax,%rax,1)
  152d30:	movzbl 0x1(%rcx,%rdi,1),%r9d
  152d36:	and    $0x7,%r9d
  152d3a:	shl    $0x4,%r9d
  152d3e:	movups (%r8,%r9,1),%xmm5
  152d43:	movaps 0x30(%rsp,%r9,1),%xmm6
  152d49:	mulps  %xmm3,%xmm6
  152d4c:	addps  %xmm5,%xmm6
  152d4f:	movaps (%r15,%r9,1),%xmm5
  152d54:	mulps  %xmm4,%xmm5
  152d57:	addps  %xmm6,%xmm5
  152d5a:	movups %xmm5,(%r8,%r9,1)
  152d5f:	inc    %rdi
  152d62:	cmp    %rdi,%rdx
  152d65:	jne    152d30 <posewise::shape::linear::System::set+0x6e0>
  152d67:	jmp    152b50 <posewise::shape::linear::System::set+0x500>
  152d6c:	shl    $0x2,%edi
  152d6f:	cmp    $0x1e,%rdi
  152d73:	mov    $0x1e,%r8d
  152d79:	cmovb  %rdi,%r8
  152d7d:	cmp    $0x1e,%r8
  152d81:	je     152b50 <posewise::shape::linear::System::set+0x500>
  152d87:	nopw   0x0(%rax,%rax,1)
  152d90:	cmp    %r8,%rdi
  152d93:	je     152da3 <posewise::shape::linear::System::set+0x753>
  152d95:	inc    %r8
  152d98:	cmp    $0x1e,%r8
  152d9c:	jne    152d90 <posewise::shape::linear::System::set+0x740>
  152d9e:	jmp    152b50 <posewise::shape::linear::System::set+0x500>
  152da3:	lea    0x1(%r8),%rdi
  152da7:	jmp    152b72 <posewise::shape::linear::System::set+0x522>
  152dac:	mov    0x8(%rsp),%rcx
  152db1:	mov    0x80(%rcx),%rax
  152db8:	mov    0x88(%rcx),%rdx
  152dbf:	cmp    $0x18,%rdx
  152dc3:	mov    $0x18,%ecx
  152dc8:	cmovb  %rdx,%rcx
  152dcc:	test   %rdx,%rdx
  152dcf:	je     152e3e <posewise::shape::linear::System::set+0x7ee>
  152dd1:	mov    %rcx,%rsi
  152dd4:	shl    $0x7,%rsi
  152dd8:	mov    $0xf00,%edi
  152ddd:	xor    %r8d,%r8d
  152de0:	movss  -0x148d80(%rip),%xmm0        # a068 <anon.1c216c64dcdb6b91b2c04cd0c3651c4c.0.llvm.574870022964000649+0x4>
  152de8:	mov    %rbx,%r9
  152deb:	nopl   0x0(%rax,%rax,1)
  152df0:	movss  -0xf00(%rax,%rdi,1),%xmm1
  152df9:	mulss  %xmm1,%xmm1
  152dfd:	movaps %xmm0,%xmm2
  152e00:	divss  %xmm1,%xmm2
  152e04:	movss  (%r9),%xmm1
  152e09:	addss  %xmm2,%xmm1
  152e0d:	movss  %xmm1,(%r9)
  152e12:	mulss  -0xe80(%r14,%rdi,1),%xmm2
  152e1c:	movss  (%rbx,%rdi,1),%xmm1
  152e21:	subss  %xmm2,%xmm1
  152e25:	movss  %xmm1,(%rbx,%rdi,1)
  152e2a:	add    $0x84,%r9
  152e31:	add    $0x4,%rdi
  152e35:	sub    $0xffffffffffffff80,%r8
  152e39:	cmp    %r8,%rsi
  152e3c:	jne    152df0 <posewise::shape::linear::System::set+0x7a0>
  152e3e:	mov    0x10(%rsp),%rsi
  152e43:	mov    0x30(%rsi),%r12
  152e47:	test   %r12,%r12
  152e4a:	lea    0xe0(%r14),%rbp
  152e51:	je     153091 <posewise::shape::linear::System::set+0xa41>
  152e57:	lea    0xf00(%rbx),%r15
  152e5e:	lea    0x18(%rsp),%rdi
  152e63:	mov    %r12,%rsi
  152e66:	mov    %rbp,%rdx
  152e69:	call   1520c0 <posewise::shape::linear::RotationTerm::new>
  152e6e:	movss  0x24(%rsp),%xmm2
  152e74:	movss  0x44(%r12),%xmm1
  152e7b:	mulss  %xmm2,%xmm1
  152e7f:	movups 0x24(%r12),%xmm3
  152e85:	movss  0x20(%rsp),%xmm0
  152e8b:	mulss  %xmm2,%xmm0
  152e8f:	movsd  0x18(%rsp),%xmm4
  152e95:	movaps %xmm4,%xmm5
  152e98:	unpcklps %xmm2,%xmm5
  152e9b:	movss  %xmm2,%xmm4
  152e9f:	shufps $0x0,%xmm2,%xmm2
  152ea3:	mulps  %xmm2,%xmm3
  152ea6:	movaps %xmm3,0x1b0(%rsp)
  152eae:	movups 0x34(%r12),%xmm3
  152eb4:	mulps  %xmm2,%xmm3
  152eb7:	movaps %xmm3,0x1c0(%rsp)
  152ebf:	movss  %xmm1,0x1d0(%rsp)
  152ec8:	lea    0xf78(%rbx),%rax
  152ecf:	lea    0x1d4(%rsp),%rcx
  152ed7:	xorps  %xmm1,%xmm1
  152eda:	movups %xmm1,0x15c(%rsp)
  152ee2:	movups %xmm1,0xa8(%rsp)
  152eea:	mov    %rbx,0x30(%rsp)
  152eef:	mov    %r15,0x38(%rsp)
  152ef4:	mov    %r15,0x40(%rsp)
  152ef9:	mov    %rax,0x48(%rsp)
  152efe:	movq   $0x0,0x50(%rsp)
  152f07:	movq   $0x1e,0x58(%rsp)
  152f10:	movq   $0x18,0x60(%rsp)
  152f19:	lea    0x1b0(%rsp),%rax
  152f21:	mov    %rax,0x68(%rsp)
  152f26:	mov    %rcx,0x70(%rsp)
  152f2b:	movq   $0x0,0x78(%rsp)
  152f34:	movq   $0x3,0x80(%rsp)
  152f40:	mulps  %xmm5,%xmm4
  152f43:	movlps %xmm4,0x88(%rsp)
  152f4b:	movss  %xmm0,0x90(%rsp)
  152f54:	movups 0x158(%rsp),%xmm0
  152f5c:	movups %xmm0,0x94(%rsp)
  152f64:	mov    0x168(%rsp),%eax
  152f6b:	mov    %eax,0xa4(%rsp)
  152f72:	mov    $0x18,%esi
  152f77:	lea    0x30(%rsp),%r13
  152f7c:	test   %rsi,%rsi
  152f7f:	jne    153057 <posewise::shape::linear::System::set+0xa07>
  152f85:	data16 cs nopw 0x0(%rax,%rax,1)
  152f90:	mov    0x50(%rsp),%rdx
  152f95:	cmp    0x58(%rsp),%rdx
  152f9a:	jae    152fd0 <posewise::shape::linear::System::set+0x980>
  152f9c:	lea    0x1(%rdx),%rax
  152fa0:	mov    %rax,0x50(%rsp)
  152fa5:	mov    %rdx,%rax
  152fa8:	shl    $0x7,%rax
  152fac:	add    0x30(%rsp),%rax
  152fb1:	shl    $0x2,%rdx
  152fb5:	add    0x40(%rsp),%rdx
  152fba:	test   %rax,%rax
  152fbd:	jne    152fdb <posewise::shape::linear::System::set+0x98b>
  152fbf:	jmp    153071 <posewise::shape::linear::System::set+0xa21>
  152fc4:	data16 data16 cs nopw 0x0(%rax,%rax,1)
  152fd0:	xor    %eax,%eax
  152fd2:	test   %rax,%rax
  152fd5:	je     153071 <posewise::shape::linear::System::set+0xa21>
  152fdb:	mov    0x68(%rsp),%rcx
  152fe0:	cmp    0x70(%rsp),%rcx
  152fe5:	je     153071 <posewise::shape::linear::System::set+0xa21>
  152feb:	lea    0xc(%rcx),%rsi
  152fef:	mov    %rsi,0x68(%rsp)
  152ff4:	mov    0x78(%rsp),%rsi
  152ff9:	cmp    %rsi,0x80(%rsp)
  153001:	je     153071 <posewise::shape::linear::System::set+0xa21>
  153003:	lea    0x1(%rsi),%rdi
  153007:	mov    %rdi,0x78(%rsp)
  15300c:	movss  0x88(%rsp,%rsi,4),%xmm0
  153015:	movss  (%rcx),%xmm1
  153019:	addss  0x60(%rax),%xmm1
  15301e:	movss  %xmm1,0x60(%rax)
  153023:	movss  0x4(%rcx),%xmm1
  153028:	addss  0x64(%rax),%xmm1
  15302d:	movss  %xmm1,0x64(%rax)
  153032:	movss  0x8(%rcx),%xmm1
  153037:	addss  0x68(%rax),%xmm1
  15303c:	movss  %xmm1,0x68(%rax)
  153041:	addss  (%rdx),%xmm0
  153045:	movss  %xmm0,(%rdx)
  153049:	mov    0x60(%rsp),%rsi
  15304e:	test   %rsi,%rsi
  153051:	je     152f90 <posewise::shape::linear::System::set+0x940>
  153057:	movq   $0x0,0x60(%rsp)
  153060:	mov    %r13,%rdi
  153063:	call   133400 <<core::iter::adapters::zip::Zip<A,B> as core::iter::traits::iterator::Iterator>::nth>
  153068:	test   %rax,%rax
  15306b:	jne    152fdb <posewise::shape::linear::System::set+0x98b>
  153071:	mov    0x8(%rsp),%rcx
  153076:	mov    0x80(%rcx),%rax
  15307d:	mov    0x88(%rcx),%rdx
  153084:	cmp    $0x18,%rdx
  153088:	mov    $0x18,%ecx
  15308d:	cmovb  %rdx,%rcx
  153091:	test   %rdx,%rdx
  153094:	je     153151 <posewise::shape::linear::System::set+0xb01>
  15309a:	movss  0xf80(%rbx),%xmm0
  1530a2:	cmp    $0x1,%rcx
  1530a6:	jne    1530ac <posewise::shape::linear::System::set+0xa5c>
  1530a8:	xor    %edx,%edx
  1530aa:	jmp    15311b <posewise::shape::linear::System::set+0xacb>
  1530ac:	mov    %ecx,%esi
  1530ae:	and    $0x1e,%esi
  1530b1:	xor    %edx,%edx
  1530b3:	movss  -0x149053(%rip),%xmm1        # a068 <anon.1c216c64dcdb6b91b2c04cd0c3651c4c.0.llvm.574870022964000649+0x4>
  1530bb:	nopl   0x0(%rax,%rax,1)
  1530c0:	movss  (%rax,%rdx,4),%xmm2
  1530c5:	movss  0x4(%rax,%rdx,4),%xmm3
  1530cb:	mulss  %xmm2,%xmm2
  1530cf:	movaps %xmm1,%xmm4
  1530d2:	divss  %xmm2,%xmm4
  1530d6:	movss  0x80(%r14,%rdx,4),%xmm2
  1530e0:	movss  0x84(%r14,%rdx,4),%xmm5
  1530ea:	mulss  %xmm2,%xmm4
  1530ee:	mulss  %xmm2,%xmm4
  1530f2:	addss  %xmm0,%xmm4
  1530f6:	add    $0x2,%rdx
  1530fa:	mulss  %xmm3,%xmm3
  1530fe:	movaps %xmm1,%xmm0
  153101:	divss  %xmm3,%xmm0
  153105:	mulss  %xmm5,%xmm0
  153109:	mulss  %xmm5,%xmm0
  15310d:	addss  %xmm4,%xmm0
  153111:	cmp    %rdx,%rsi
  153114:	jne    1530c0 <posewise::shape::linear::System::set+0xa70>
  153116:	test   $0x1,%cl
  153119:	je     153149 <posewise::shape::linear::System::set+0xaf9>
  15311b:	movaps %xmm0,%xmm1
  15311e:	movss  (%rax,%rdx,4),%xmm2
  153123:	mulss  %xmm2,%xmm2
  153127:	movss  -0x1490c7(%rip),%xmm0        # a068 <anon.1c216c64dcdb6b91b2c04cd0c3651c4c.0.llvm.574870022964000649+0x4>
  15312f:	divss  %xmm2,%xmm0
  153133:	movss  0x80(%r14,%rdx,4),%xmm2
  15313d:	mulss  %xmm2,%xmm0
  153141:	mulss  %xmm2,%xmm0
  153145:	addss  %xmm1,%xmm0
  153149:	movss  %xmm0,0xf80(%rbx)
  153151:	test   %r12,%r12
  153154:	je     15317c <posewise::shape::linear::System::set+0xb2c>
  153156:	lea    0x30(%rsp),%rdi
  15315b:	mov    %r12,%rsi
  15315e:	mov    %rbp,%rdx
  153161:	call   1520c0 <posewise::shape::linear::RotationTerm::new>
  153166:	movss  0x40(%rsp),%xmm0
  15316c:	addss  0xf80(%rbx),%xmm0
  153174:	movss  %xmm0,0xf80(%rbx)
  15317c:	add    $0x238,%rsp
  153183:	pop    %rbx
  153184:	pop    %r12
  153186:	pop    %r13
  153188:	pop    %r14
  15318a:	pop    %r15
  15318c:	pop    %rbp
  15318d:	ret
  15318e:	int3
  15318f:	int3

