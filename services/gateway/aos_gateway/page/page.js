var Je,x,tn,Ze,ae,Xt,nn,sn,on,xt,yt,wt,bs,Ee={},rn=[],ys=/acit|ex(?:s|g|n|p|$)|rph|grid|ows|mnc|ntw|ine[ch]|zoo|^ord|itera/i,Xe=Array.isArray;function Y(e,t){for(var n in t)e[n]=t[n];return e}function kt(e){e&&e.parentNode&&e.parentNode.removeChild(e)}function Qe(e,t,n){var s,o,i,r={};for(i in t)i=="key"?s=t[i]:i=="ref"?o=t[i]:r[i]=t[i];if(arguments.length>2&&(r.children=arguments.length>3?Je.call(arguments,2):n),typeof e=="function"&&e.defaultProps!=null)for(i in e.defaultProps)r[i]===void 0&&(r[i]=e.defaultProps[i]);return Ge(e,r,s,o,null)}function Ge(e,t,n,s,o){var i={type:e,props:t,key:n,ref:s,__k:null,__:null,__b:0,__e:null,__c:null,constructor:void 0,__v:o??++tn,__i:-1,__u:0};return o==null&&x.vnode!=null&&x.vnode(i),i}function Ye(e){return e.children}function le(e,t){this.props=e,this.context=t}function ge(e,t){if(t==null)return e.__?ge(e.__,e.__i+1):null;for(var n;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null)return n.__e;return typeof e.type=="function"?ge(e):null}function an(e){var t,n;if((e=e.__)!=null&&e.__c!=null){for(e.__e=e.__c.base=null,t=0;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null){e.__e=e.__c.base=n.__e;break}return an(e)}}function Qt(e){(!e.__d&&(e.__d=!0)&&ae.push(e)&&!Ke.__r++||Xt!=x.debounceRendering)&&((Xt=x.debounceRendering)||nn)(Ke)}function Ke(){for(var e,t,n,s,o,i,r,c=1;ae.length;)ae.length>c&&ae.sort(sn),e=ae.shift(),c=ae.length,e.__d&&(n=void 0,o=(s=(t=e).__v).__e,i=[],r=[],t.__P&&((n=Y({},s)).__v=s.__v+1,x.vnode&&x.vnode(n),St(t.__P,n,s,t.__n,t.__P.namespaceURI,32&s.__u?[o]:null,i,o??ge(s),!!(32&s.__u),r),n.__v=s.__v,n.__.__k[n.__i]=n,un(i,n,r),n.__e!=o&&an(n)));Ke.__r=0}function ln(e,t,n,s,o,i,r,c,d,l,p){var u,h,f,v,m,_,b=s&&s.__k||rn,y=t.length;for(d=ws(n,t,b,d,y),u=0;u<y;u++)(f=n.__k[u])!=null&&(h=f.__i==-1?Ee:b[f.__i]||Ee,f.__i=u,_=St(e,f,h,o,i,r,c,d,l,p),v=f.__e,f.ref&&h.ref!=f.ref&&(h.ref&&Ct(h.ref,null,f),p.push(f.ref,f.__c||v,f)),m==null&&v!=null&&(m=v),4&f.__u||h.__k===f.__k?d=cn(f,d,e):typeof f.type=="function"&&_!==void 0?d=_:v&&(d=v.nextSibling),f.__u&=-7);return n.__e=m,d}function ws(e,t,n,s,o){var i,r,c,d,l,p=n.length,u=p,h=0;for(e.__k=new Array(o),i=0;i<o;i++)(r=t[i])!=null&&typeof r!="boolean"&&typeof r!="function"?(d=i+h,(r=e.__k[i]=typeof r=="string"||typeof r=="number"||typeof r=="bigint"||r.constructor==String?Ge(null,r,null,null,null):Xe(r)?Ge(Ye,{children:r},null,null,null):r.constructor==null&&r.__b>0?Ge(r.type,r.props,r.key,r.ref?r.ref:null,r.__v):r).__=e,r.__b=e.__b+1,c=null,(l=r.__i=xs(r,n,d,u))!=-1&&(u--,(c=n[l])&&(c.__u|=2)),c==null||c.__v==null?(l==-1&&(o>p?h--:o<p&&h++),typeof r.type!="function"&&(r.__u|=4)):l!=d&&(l==d-1?h--:l==d+1?h++:(l>d?h--:h++,r.__u|=4))):e.__k[i]=null;if(u)for(i=0;i<p;i++)(c=n[i])!=null&&(2&c.__u)==0&&(c.__e==s&&(s=ge(c)),pn(c,c));return s}function cn(e,t,n){var s,o;if(typeof e.type=="function"){for(s=e.__k,o=0;s&&o<s.length;o++)s[o]&&(s[o].__=e,t=cn(s[o],t,n));return t}e.__e!=t&&(t&&e.type&&!n.contains(t)&&(t=ge(e)),n.insertBefore(e.__e,t||null),t=e.__e);do t=t&&t.nextSibling;while(t!=null&&t.nodeType==8);return t}function xs(e,t,n,s){var o,i,r=e.key,c=e.type,d=t[n];if(d===null&&e.key==null||d&&r==d.key&&c==d.type&&(2&d.__u)==0)return n;if(s>(d!=null&&(2&d.__u)==0?1:0))for(o=n-1,i=n+1;o>=0||i<t.length;){if(o>=0){if((d=t[o])&&(2&d.__u)==0&&r==d.key&&c==d.type)return o;o--}if(i<t.length){if((d=t[i])&&(2&d.__u)==0&&r==d.key&&c==d.type)return i;i++}}return-1}function Yt(e,t,n){t[0]=="-"?e.setProperty(t,n??""):e[t]=n==null?"":typeof n!="number"||ys.test(t)?n:n+"px"}function Ve(e,t,n,s,o){var i,r;e:if(t=="style")if(typeof n=="string")e.style.cssText=n;else{if(typeof s=="string"&&(e.style.cssText=s=""),s)for(t in s)n&&t in n||Yt(e.style,t,"");if(n)for(t in n)s&&n[t]==s[t]||Yt(e.style,t,n[t])}else if(t[0]=="o"&&t[1]=="n")i=t!=(t=t.replace(on,"$1")),r=t.toLowerCase(),t=r in e||t=="onFocusOut"||t=="onFocusIn"?r.slice(2):t.slice(2),e.l||(e.l={}),e.l[t+i]=n,n?s?n.u=s.u:(n.u=xt,e.addEventListener(t,i?wt:yt,i)):e.removeEventListener(t,i?wt:yt,i);else{if(o=="http://www.w3.org/2000/svg")t=t.replace(/xlink(H|:h)/,"h").replace(/sName$/,"s");else if(t!="width"&&t!="height"&&t!="href"&&t!="list"&&t!="form"&&t!="tabIndex"&&t!="download"&&t!="rowSpan"&&t!="colSpan"&&t!="role"&&t!="popover"&&t in e)try{e[t]=n??"";break e}catch{}typeof n=="function"||(n==null||n===!1&&t[4]!="-"?e.removeAttribute(t):e.setAttribute(t,t=="popover"&&n==1?"":n))}}function en(e){return function(t){if(this.l){var n=this.l[t.type+e];if(t.t==null)t.t=xt++;else if(t.t<n.u)return;return n(x.event?x.event(t):t)}}}function St(e,t,n,s,o,i,r,c,d,l){var p,u,h,f,v,m,_,b,y,Se,se,qe,Ce,Zt,Be,Me,bt,G=t.type;if(t.constructor!=null)return null;128&n.__u&&(d=!!(32&n.__u),i=[c=t.__e=n.__e]),(p=x.__b)&&p(t);e:if(typeof G=="function")try{if(b=t.props,y="prototype"in G&&G.prototype.render,Se=(p=G.contextType)&&s[p.__c],se=p?Se?Se.props.value:p.__:s,n.__c?_=(u=t.__c=n.__c).__=u.__E:(y?t.__c=u=new G(b,se):(t.__c=u=new le(b,se),u.constructor=G,u.render=Ss),Se&&Se.sub(u),u.props=b,u.state||(u.state={}),u.context=se,u.__n=s,h=u.__d=!0,u.__h=[],u._sb=[]),y&&u.__s==null&&(u.__s=u.state),y&&G.getDerivedStateFromProps!=null&&(u.__s==u.state&&(u.__s=Y({},u.__s)),Y(u.__s,G.getDerivedStateFromProps(b,u.__s))),f=u.props,v=u.state,u.__v=t,h)y&&G.getDerivedStateFromProps==null&&u.componentWillMount!=null&&u.componentWillMount(),y&&u.componentDidMount!=null&&u.__h.push(u.componentDidMount);else{if(y&&G.getDerivedStateFromProps==null&&b!==f&&u.componentWillReceiveProps!=null&&u.componentWillReceiveProps(b,se),!u.__e&&u.shouldComponentUpdate!=null&&u.shouldComponentUpdate(b,u.__s,se)===!1||t.__v==n.__v){for(t.__v!=n.__v&&(u.props=b,u.state=u.__s,u.__d=!1),t.__e=n.__e,t.__k=n.__k,t.__k.some(function(Te){Te&&(Te.__=t)}),qe=0;qe<u._sb.length;qe++)u.__h.push(u._sb[qe]);u._sb=[],u.__h.length&&r.push(u);break e}u.componentWillUpdate!=null&&u.componentWillUpdate(b,u.__s,se),y&&u.componentDidUpdate!=null&&u.__h.push(function(){u.componentDidUpdate(f,v,m)})}if(u.context=se,u.props=b,u.__P=e,u.__e=!1,Ce=x.__r,Zt=0,y){for(u.state=u.__s,u.__d=!1,Ce&&Ce(t),p=u.render(u.props,u.state,u.context),Be=0;Be<u._sb.length;Be++)u.__h.push(u._sb[Be]);u._sb=[]}else do u.__d=!1,Ce&&Ce(t),p=u.render(u.props,u.state,u.context),u.state=u.__s;while(u.__d&&++Zt<25);u.state=u.__s,u.getChildContext!=null&&(s=Y(Y({},s),u.getChildContext())),y&&!h&&u.getSnapshotBeforeUpdate!=null&&(m=u.getSnapshotBeforeUpdate(f,v)),Me=p,p!=null&&p.type===Ye&&p.key==null&&(Me=dn(p.props.children)),c=ln(e,Xe(Me)?Me:[Me],t,n,s,o,i,r,c,d,l),u.base=t.__e,t.__u&=-161,u.__h.length&&r.push(u),_&&(u.__E=u.__=null)}catch(Te){if(t.__v=null,d||i!=null)if(Te.then){for(t.__u|=d?160:128;c&&c.nodeType==8&&c.nextSibling;)c=c.nextSibling;i[i.indexOf(c)]=null,t.__e=c}else for(bt=i.length;bt--;)kt(i[bt]);else t.__e=n.__e,t.__k=n.__k;x.__e(Te,t,n)}else i==null&&t.__v==n.__v?(t.__k=n.__k,t.__e=n.__e):c=t.__e=ks(n.__e,t,n,s,o,i,r,d,l);return(p=x.diffed)&&p(t),128&t.__u?void 0:c}function un(e,t,n){for(var s=0;s<n.length;s++)Ct(n[s],n[++s],n[++s]);x.__c&&x.__c(t,e),e.some(function(o){try{e=o.__h,o.__h=[],e.some(function(i){i.call(o)})}catch(i){x.__e(i,o.__v)}})}function dn(e){return typeof e!="object"||e==null||e.__b&&e.__b>0?e:Xe(e)?e.map(dn):Y({},e)}function ks(e,t,n,s,o,i,r,c,d){var l,p,u,h,f,v,m,_=n.props,b=t.props,y=t.type;if(y=="svg"?o="http://www.w3.org/2000/svg":y=="math"?o="http://www.w3.org/1998/Math/MathML":o||(o="http://www.w3.org/1999/xhtml"),i!=null){for(l=0;l<i.length;l++)if((f=i[l])&&"setAttribute"in f==!!y&&(y?f.localName==y:f.nodeType==3)){e=f,i[l]=null;break}}if(e==null){if(y==null)return document.createTextNode(b);e=document.createElementNS(o,y,b.is&&b),c&&(x.__m&&x.__m(t,i),c=!1),i=null}if(y==null)_===b||c&&e.data==b||(e.data=b);else{if(i=i&&Je.call(e.childNodes),_=n.props||Ee,!c&&i!=null)for(_={},l=0;l<e.attributes.length;l++)_[(f=e.attributes[l]).name]=f.value;for(l in _)if(f=_[l],l!="children"){if(l=="dangerouslySetInnerHTML")u=f;else if(!(l in b)){if(l=="value"&&"defaultValue"in b||l=="checked"&&"defaultChecked"in b)continue;Ve(e,l,null,f,o)}}for(l in b)f=b[l],l=="children"?h=f:l=="dangerouslySetInnerHTML"?p=f:l=="value"?v=f:l=="checked"?m=f:c&&typeof f!="function"||_[l]===f||Ve(e,l,f,_[l],o);if(p)c||u&&(p.__html==u.__html||p.__html==e.innerHTML)||(e.innerHTML=p.__html),t.__k=[];else if(u&&(e.innerHTML=""),ln(t.type=="template"?e.content:e,Xe(h)?h:[h],t,n,s,y=="foreignObject"?"http://www.w3.org/1999/xhtml":o,i,r,i?i[0]:n.__k&&ge(n,0),c,d),i!=null)for(l=i.length;l--;)kt(i[l]);c||(l="value",y=="progress"&&v==null?e.removeAttribute("value"):v!=null&&(v!==e[l]||y=="progress"&&!v||y=="option"&&v!=_[l])&&Ve(e,l,v,_[l],o),l="checked",m!=null&&m!=e[l]&&Ve(e,l,m,_[l],o))}return e}function Ct(e,t,n){try{if(typeof e=="function"){var s=typeof e.__u=="function";s&&e.__u(),s&&t==null||(e.__u=e(t))}else e.current=t}catch(o){x.__e(o,n)}}function pn(e,t,n){var s,o;if(x.unmount&&x.unmount(e),(s=e.ref)&&(s.current&&s.current!=e.__e||Ct(s,null,t)),(s=e.__c)!=null){if(s.componentWillUnmount)try{s.componentWillUnmount()}catch(i){x.__e(i,t)}s.base=s.__P=null}if(s=e.__k)for(o=0;o<s.length;o++)s[o]&&pn(s[o],t,n||typeof e.type!="function");n||kt(e.__e),e.__c=e.__=e.__e=void 0}function Ss(e,t,n){return this.constructor(e,n)}function Mt(e,t,n){var s,o,i,r;t==document&&(t=document.documentElement),x.__&&x.__(e,t),o=(s=typeof n=="function")?null:n&&n.__k||t.__k,i=[],r=[],St(t,e=(!s&&n||t).__k=Qe(Ye,null,[e]),o||Ee,Ee,t.namespaceURI,!s&&n?[n]:o?null:t.firstChild?Je.call(t.childNodes):null,i,!s&&n?n:o?o.__e:t.firstChild,s,r),un(i,e,r)}Je=rn.slice,x={__e:function(e,t,n,s){for(var o,i,r;t=t.__;)if((o=t.__c)&&!o.__)try{if((i=o.constructor)&&i.getDerivedStateFromError!=null&&(o.setState(i.getDerivedStateFromError(e)),r=o.__d),o.componentDidCatch!=null&&(o.componentDidCatch(e,s||{}),r=o.__d),r)return o.__E=o}catch(c){e=c}throw e}},tn=0,Ze=function(e){return e!=null&&e.constructor==null},le.prototype.setState=function(e,t){var n;n=this.__s!=null&&this.__s!=this.state?this.__s:this.__s=Y({},this.state),typeof e=="function"&&(e=e(Y({},n),this.props)),e&&Y(n,e),e!=null&&this.__v&&(t&&this._sb.push(t),Qt(this))},le.prototype.forceUpdate=function(e){this.__v&&(this.__e=!0,e&&this.__h.push(e),Qt(this))},le.prototype.render=Ye,ae=[],nn=typeof Promise=="function"?Promise.prototype.then.bind(Promise.resolve()):setTimeout,sn=function(e,t){return e.__v.__b-t.__v.__b},Ke.__r=0,on=/(PointerCapture)$|Capture$/i,xt=0,yt=en(!1),wt=en(!0),bs=0;var hn=function(e,t,n,s){var o;t[0]=0;for(var i=1;i<t.length;i++){var r=t[i++],c=t[i]?(t[0]|=r?1:2,n[t[i++]]):t[++i];r===3?s[0]=c:r===4?s[1]=Object.assign(s[1]||{},c):r===5?(s[1]=s[1]||{})[t[++i]]=c:r===6?s[1][t[++i]]+=c+"":r?(o=e.apply(c,hn(e,c,n,["",null])),s.push(o),c[0]?t[0]|=2:(t[i-2]=0,t[i]=o)):s.push(c)}return s},fn=new Map;function mn(e){var t=fn.get(this);return t||(t=new Map,fn.set(this,t)),(t=hn(this,t.get(e)||(t.set(e,t=function(n){for(var s,o,i=1,r="",c="",d=[0],l=function(h){i===1&&(h||(r=r.replace(/^\s*\n\s*|\s*\n\s*$/g,"")))?d.push(0,h,r):i===3&&(h||r)?(d.push(3,h,r),i=2):i===2&&r==="..."&&h?d.push(4,h,0):i===2&&r&&!h?d.push(5,0,!0,r):i>=5&&((r||!h&&i===5)&&(d.push(i,0,r,o),i=6),h&&(d.push(i,h,0,o),i=6)),r=""},p=0;p<n.length;p++){p&&(i===1&&l(),l(p));for(var u=0;u<n[p].length;u++)s=n[p][u],i===1?s==="<"?(l(),d=[d],i=3):r+=s:i===4?r==="--"&&s===">"?(i=1,r=""):r=s+r[0]:c?s===c?c="":r+=s:s==='"'||s==="'"?c=s:s===">"?(l(),i=1):i&&(s==="="?(i=5,o=r,r=""):s==="/"&&(i<5||n[p][u+1]===">")?(l(),i===3&&(d=d[0]),i=d,(d=d[0]).push(2,0,i),i=0):s===" "||s==="	"||s===`
`||s==="\r"?(l(),i=2):r+=s),i===3&&r==="!--"&&(i=4,d=d[0])}return l(),d}(e)),t),arguments,[])).length>1?t:t[0]}var a=mn.bind(Qe);var Oe,N,Tt,vn,tt=0,kn=[],R=x,_n=R.__b,$n=R.__r,gn=R.diffed,bn=R.__c,yn=R.unmount,wn=R.__;function Ot(e,t){R.__h&&R.__h(N,e,tt||t),tt=0;var n=N.__H||(N.__H={__:[],__h:[]});return e>=n.__.length&&n.__.push({}),n.__[e]}function $(e){return tt=1,Cs(Cn,e)}function Cs(e,t,n){var s=Ot(Oe++,2);if(s.t=e,!s.__c&&(s.__=[n?n(t):Cn(void 0,t),function(c){var d=s.__N?s.__N[0]:s.__[0],l=s.t(d,c);d!==l&&(s.__N=[l,s.__[1]],s.__c.setState({}))}],s.__c=N,!N.__f)){var o=function(c,d,l){if(!s.__c.__H)return!0;var p=s.__c.__H.__.filter(function(h){return!!h.__c});if(p.every(function(h){return!h.__N}))return!i||i.call(this,c,d,l);var u=s.__c.props!==c;return p.forEach(function(h){if(h.__N){var f=h.__[0];h.__=h.__N,h.__N=void 0,f!==h.__[0]&&(u=!0)}}),i&&i.call(this,c,d,l)||u};N.__f=!0;var i=N.shouldComponentUpdate,r=N.componentWillUpdate;N.componentWillUpdate=function(c,d,l){if(this.__e){var p=i;i=void 0,o(c,d,l),i=p}r&&r.call(this,c,d,l)},N.shouldComponentUpdate=o}return s.__N||s.__}function k(e,t){var n=Ot(Oe++,3);!R.__s&&Sn(n.__H,t)&&(n.__=e,n.u=t,N.__H.__h.push(n))}function ce(e){return tt=5,nt(function(){return{current:e}},[])}function nt(e,t){var n=Ot(Oe++,7);return Sn(n.__H,t)&&(n.__=e(),n.__H=t,n.__h=e),n.__}function Ms(){for(var e;e=kn.shift();)if(e.__P&&e.__H)try{e.__H.__h.forEach(et),e.__H.__h.forEach(Et),e.__H.__h=[]}catch(t){e.__H.__h=[],R.__e(t,e.__v)}}R.__b=function(e){N=null,_n&&_n(e)},R.__=function(e,t){e&&t.__k&&t.__k.__m&&(e.__m=t.__k.__m),wn&&wn(e,t)},R.__r=function(e){$n&&$n(e),Oe=0;var t=(N=e.__c).__H;t&&(Tt===N?(t.__h=[],N.__h=[],t.__.forEach(function(n){n.__N&&(n.__=n.__N),n.u=n.__N=void 0})):(t.__h.forEach(et),t.__h.forEach(Et),t.__h=[],Oe=0)),Tt=N},R.diffed=function(e){gn&&gn(e);var t=e.__c;t&&t.__H&&(t.__H.__h.length&&(kn.push(t)!==1&&vn===R.requestAnimationFrame||((vn=R.requestAnimationFrame)||Ts)(Ms)),t.__H.__.forEach(function(n){n.u&&(n.__H=n.u),n.u=void 0})),Tt=N=null},R.__c=function(e,t){t.some(function(n){try{n.__h.forEach(et),n.__h=n.__h.filter(function(s){return!s.__||Et(s)})}catch(s){t.some(function(o){o.__h&&(o.__h=[])}),t=[],R.__e(s,n.__v)}}),bn&&bn(e,t)},R.unmount=function(e){yn&&yn(e);var t,n=e.__c;n&&n.__H&&(n.__H.__.forEach(function(s){try{et(s)}catch(o){t=o}}),n.__H=void 0,t&&R.__e(t,n.__v))};var xn=typeof requestAnimationFrame=="function";function Ts(e){var t,n=function(){clearTimeout(s),xn&&cancelAnimationFrame(t),setTimeout(e)},s=setTimeout(n,35);xn&&(t=requestAnimationFrame(n))}function et(e){var t=N,n=e.__c;typeof n=="function"&&(e.__c=void 0,n()),N=t}function Et(e){var t=N;e.__c=e.__(),N=t}function Sn(e,t){return!e||e.length!==t.length||t.some(function(n,s){return n!==e[s]})}function Cn(e,t){return typeof t=="function"?t(e):t}var Es=Symbol.for("preact-signals");function rt(){if(ee>1)ee--;else{var e,t=!1;for(function(){var o=ot;for(ot=void 0;o!==void 0;){var i=o.S;if(i.v===o.v)for(var r=i.t;r!==void 0;r=r.x)r.i===o.i&&(r.i=i.i);o=o.o}}();Re!==void 0;){var n=Re;for(Re=void 0,st++;n!==void 0;){var s=n.u;if(n.u=void 0,n.f&=-3,!(8&n.f)&&Tn(n))try{n.c()}catch(o){t||(e=o,t=!0)}n=s}}if(st=0,ee--,t)throw e}}function ue(e){if(ee>0)return e();Nt=++Os,ee++;try{return e()}finally{rt()}}var Ne,T=void 0;function Ae(e){var t=T,n=Ne;T=void 0,Ne=void 0;try{return e()}finally{T=t,Ne=n}}var Re=void 0,ee=0,st=0,Os=0,Nt=0,ot=void 0,it=0;function Mn(e){if(T!==void 0){var t=e.n;if(t===void 0||t.t!==T)return t={i:0,S:e,p:T.s,n:void 0,t:T,e:void 0,x:void 0,r:t},T.s!==void 0&&(T.s.n=t),T.s=t,e.n=t,32&T.f&&e.S(t),t;if(t.i===-1)return t.i=0,t.n!==void 0&&(t.n.p=t.p,t.p!==void 0&&(t.p.n=t.n),t.p=T.s,t.n=void 0,T.s.n=t,T.s=t),t}}function A(e,t){this.v=e,this.i=0,this.n=void 0,this.t=void 0,this.l=0,this.W=t?.watched,this.Z=t?.unwatched,this.name=t?.name}A.prototype.brand=Es;A.prototype.h=function(){return!0};A.prototype.S=function(e){var t=this,n=this.t;n!==e&&e.e===void 0&&(e.x=n,this.t=e,n!==void 0?n.e=e:Ae(function(){var s;(s=t.W)==null||s.call(t)}))};A.prototype.U=function(e){var t=this;if(this.t!==void 0){var n=e.e,s=e.x;n!==void 0&&(n.x=s,e.e=void 0),s!==void 0&&(s.e=n,e.x=void 0),e===this.t&&(this.t=s,s===void 0&&Ae(function(){var o;(o=t.Z)==null||o.call(t)}))}};A.prototype.subscribe=function(e){var t=this;return ye(function(){var n=t.value;Ae(function(){return e(n)})},{name:"sub"})};A.prototype.valueOf=function(){return this.value};A.prototype.toString=function(){return this.value+""};A.prototype.toJSON=function(){return this.value};A.prototype.peek=function(){var e=this;return Ae(function(){return e.value})};Object.defineProperty(A.prototype,"value",{get:function(){var e=Mn(this);return e!==void 0&&(e.i=this.i),this.v},set:function(e){if(e!==this.v){if(st>100)throw new Error("Cycle detected");(function(n){ee!==0&&st===0&&n.l!==Nt&&(n.l=Nt,ot={S:n,v:n.v,i:n.i,o:ot})})(this),this.v=e,this.i++,it++,ee++;try{for(var t=this.t;t!==void 0;t=t.x)t.t.N()}finally{rt()}}}});function S(e,t){return new A(e,t)}function Tn(e){for(var t=e.s;t!==void 0;t=t.n)if(t.S.i!==t.i||!t.S.h()||t.S.i!==t.i)return!0;return!1}function En(e){for(var t=e.s;t!==void 0;t=t.n){var n=t.S.n;if(n!==void 0&&(t.r=n),t.S.n=t,t.i=-1,t.n===void 0){e.s=t;break}}}function On(e){for(var t=e.s,n=void 0;t!==void 0;){var s=t.p;t.i===-1?(t.S.U(t),s!==void 0&&(s.n=t.n),t.n!==void 0&&(t.n.p=s)):n=t,t.S.n=t.r,t.r!==void 0&&(t.r=void 0),t=s}e.s=n}function de(e,t){A.call(this,void 0,t),this.x=e,this.s=void 0,this.g=it-1,this.f=4}de.prototype=new A;de.prototype.h=function(){if(this.f&=-3,1&this.f)return!1;if((36&this.f)==32||(this.f&=-5,this.g===it))return!0;if(this.g=it,this.f|=1,this.i>0&&!Tn(this))return this.f&=-2,!0;var e=T;try{En(this),T=this;var t=this.x();(16&this.f||this.v!==t||this.i===0)&&(this.v=t,this.f&=-17,this.i++)}catch(n){this.v=n,this.f|=16,this.i++}return T=e,On(this),this.f&=-2,!0};de.prototype.S=function(e){if(this.t===void 0){this.f|=36;for(var t=this.s;t!==void 0;t=t.n)t.S.S(t)}A.prototype.S.call(this,e)};de.prototype.U=function(e){if(this.t!==void 0&&(A.prototype.U.call(this,e),this.t===void 0)){this.f&=-33;for(var t=this.s;t!==void 0;t=t.n)t.S.U(t)}};de.prototype.N=function(){if(!(2&this.f)){this.f|=6;for(var e=this.t;e!==void 0;e=e.x)e.t.N()}};Object.defineProperty(de.prototype,"value",{get:function(){if(1&this.f)throw new Error("Cycle detected");var e=Mn(this);if(this.h(),e!==void 0&&(e.i=this.i),16&this.f)throw this.v;return this.v}});function B(e,t){return new de(e,t)}function Nn(e){var t=e.j;if(e.j=void 0,typeof t=="function"){ee++;var n=T;T=void 0;try{t()}catch(s){throw e.f&=-2,e.f|=8,Rt(e),s}finally{T=n,rt()}}}function Rt(e){for(var t=e.s;t!==void 0;t=t.n)t.S.U(t);e.x=void 0,e.s=void 0,Nn(e)}function Ns(e){if(T!==this)throw new Error("Out-of-order effect");On(this),T=e,this.f&=-2;try{8&this.f&&Rt(this)}finally{rt()}}function be(e,t){this.x=e,this.j=void 0,this.s=void 0,this.u=void 0,this.f=32,this.name=t?.name,Ne&&Ne.push(this)}be.prototype.c=function(){var e=this.S();try{if(8&this.f||this.x===void 0)return;var t=this.x();typeof t=="function"&&(this.j=t)}finally{e()}};be.prototype.S=function(){if(1&this.f)throw new Error("Cycle detected");this.f|=1,this.f&=-9,Nn(this),En(this),ee++;var e=T;return T=this,Ns.bind(this,e)};be.prototype.N=function(){2&this.f||(this.f|=2,this.u=Re,Re=this)};be.prototype.d=function(){this.f|=8,1&this.f||Rt(this)};be.prototype.dispose=function(){this.d()};function ye(e,t){var n=new be(e,t);try{n.c()}catch(o){throw n.d(),o}var s=n.d.bind(n);return s[Symbol.dispose]=s,s}var jt,At;function we(e,t){x[e]=t.bind(null,x[e]||function(){})}function at(e){At&&At(),At=e&&e.S()}function Rn(e){var t=this,n=e.data,s=As(n);s.value=n;var o=nt(function(){for(var i=t,r=t.__v;r=r.__;)if(r.__c){r.__c.__$f|=4;break}var c=B(function(){var l=s.value.value;return l===0?0:l===!0?"":l||""}),d=B(function(){var l;return Ze(c.value)||((l=t.base)==null?void 0:l.nodeType)!==3});return t.__$u.c=function(){var l;!Ze(o.peek())&&((l=t.base)==null?void 0:l.nodeType)===3?t.base.data=o.peek():(t.__$f|=1,t.setState({}))},ye(function(){je||(je=this.N),this.N=jn,d.value&&i.base&&(i.base.data=c.value)}),c},[]);return o.value}Rn.displayName="_st";Object.defineProperties(A.prototype,{constructor:{configurable:!0,value:void 0},type:{configurable:!0,value:Rn},props:{configurable:!0,get:function(){return{data:this}}},__b:{configurable:!0,value:1}});we("__b",function(e,t){if(typeof t.type=="string"){var n,s=t.props;for(var o in s)if(o!=="children"){var i=s[o];i instanceof A&&(n||(t.__np=n={}),n[o]=i,s[o]=i.peek())}}e(t)});we("__r",function(e,t){at();var n,s=t.__c;s&&(s.__$f&=-2,(n=s.__$u)===void 0&&(s.__$u=n=function(o){var i;return ye(function(){i=this}),i.c=function(){s.__$f|=1,s.setState({})},i}())),jt=s,at(n),e(t)});we("__e",function(e,t,n,s){at(),jt=void 0,e(t,n,s)});we("diffed",function(e,t){at(),jt=void 0;var n;if(typeof t.type=="string"&&(n=t.__e)){var s=t.__np,o=t.props;if(s){var i=n.U;if(i)for(var r in i){var c=i[r];c!==void 0&&!(r in s)&&(c.d(),i[r]=void 0)}else n.U=i={};for(var d in s){var l=i[d],p=s[d];l===void 0?(l=Rs(n,d,p,o),i[d]=l):l.o(p,o)}}}e(t)});function Rs(e,t,n,s){var o=t in e&&e.ownerSVGElement===void 0,i=S(n);return{o:function(r,c){i.value=r,s=c},d:ye(function(){je||(je=this.N),this.N=jn;var r=i.value.value;s[t]!==r&&(s[t]=r,o?e[t]=r:r?e.setAttribute(t,r):e.removeAttribute(t))})}}we("unmount",function(e,t){if(typeof t.type=="string"){var n=t.__e;if(n){var s=n.U;if(s){n.U=void 0;for(var o in s){var i=s[o];i&&i.d()}}}}else{var r=t.__c;if(r){var c=r.__$u;c&&(r.__$u=void 0,c.d())}}e(t)});we("__h",function(e,t,n,s){(s<3||s===9)&&(t.__$f|=2),e(t,n,s)});le.prototype.shouldComponentUpdate=function(e,t){var n=this.__$u;if(!(n&&n.s!==void 0||4&this.__$f)||3&this.__$f)return!0;for(var s in t)return!0;for(var o in e)if(o!=="__source"&&e[o]!==this.props[o])return!0;for(var i in this.props)if(!(i in e))return!0;return!1};function As(e){return nt(function(){return S(e)},[])}var je;var An=[];var js=function(e){queueMicrotask(function(){queueMicrotask(e)})};function Is(){ue(function(){for(var e;e=An.shift();)je.call(e)})}function jn(){An.push(this)===1&&(x.requestAnimationFrame||js)(Is)}var Ie=S(innerWidth);addEventListener("resize",()=>Ie.value=innerWidth);var C=({title:e,note:t,id:n,children:s,className:o=""})=>a`
  <section class="card ${o}" aria-labelledby=${n}>
    <header class="card-head"><h2 id=${n}>${e}</h2>${t&&a`<p class="note">${t}</p>`}</header>
    ${s}
  </section>`,j=({problem:e})=>e&&a`
    <div class="problem" role="alert">
      <p><strong>${e.message}</strong>${e.code&&a` <span class="code">${e.code}</span>`}</p>
      ${e.hint&&a`<p>${e.hint}</p>`}
      ${e.diagnostics?.length>0&&a`<ul class="findings">
        ${e.diagnostics.slice(0,50).map(t=>a`<li>
          <span class="code">${t.code}</span> <span class="place">${Ps(t.span)}</span> ${t.message}
          ${t.hint&&a`<span class="hint"> ${t.hint}</span>`}
          ${t.excerpt&&a`<pre tabindex="0">${t.excerpt}</pre>`}
        </li>`)}
      </ul>`}
    </div>`,Ps=e=>[e.file,e.line,e.column].filter(Boolean).join(":");function z(){let e=ce(null),[t,n]=$(0);return k(()=>{let s=new ResizeObserver(([o])=>n(Math.floor(o.contentRect.width)));return s.observe(e.current),()=>s.disconnect()},[]),[e,t]}var It="aos-token",lt=class extends Error{constructor(t){super(t.detail||t.title||"the gateway cannot be reached"),Object.assign(this,{code:"",hint:"",diagnostics:[]},t)}},q=()=>!!localStorage.getItem(It);async function In(e){localStorage.setItem(It,e),await fetch("/v1/session",{method:"POST",headers:Pn()})}var Pn=()=>{let e=localStorage.getItem(It);return e?{authorization:`Bearer ${e}`}:{}};async function Pe(e,t={}){let n;try{n=await fetch(e,{...t,headers:{...Pn(),...t.headers}})}catch{throw new lt({detail:"The gateway cannot be reached.",hint:"Is `aos serve` still running?"})}if(n.ok)return n;let s;try{s=await n.json()}catch{s={detail:`The gateway answered ${n.status}.`}}throw new lt(s)}var I=async e=>(await Pe(e)).json(),Dn=async e=>(await Pe(e)).blob(),Un=async e=>(await Pe(e)).text(),oe=async(e,t={})=>(await Pe(e,{method:"POST",body:JSON.stringify(t),headers:{"content-type":"application/json"}})).json(),ct=async(e,t)=>(await Pe(`${e}?name=${encodeURIComponent(t.name)}`,{method:"POST",body:t})).json();var Dt=["overview","why","steps","model","documents","system"],Pt=()=>{let[e,t=""]=location.hash.replace(/^#/,"").split("?"),[n="",s="",o="overview"]=e.split("/").filter(Boolean).map(decodeURIComponent),i=new URLSearchParams(t),r=Number(i.get("step"))||null;return{kind:n,name:s,view:Dt.includes(o)?o:"overview",step:r,token:i.get("token")}},w=S({kind:"",name:"",view:"overview",step:null}),P=(e,t="overview",n=null)=>`#/missions/${encodeURIComponent(e)}${t==="overview"?"":`/${t}`}${n?`?step=${n}`:""}`;function ie(e,{replace:t=!1}={}){t?history.replaceState(null,"",e):history.pushState(null,"",e),w.value=Pt()}async function Fn(){let e=async()=>{let t=Pt();if(t.token){let n=location.hash.replace(/([?&])token=[^&]*&?/,"$1").replace(/[?&]$/,"");history.replaceState(null,"",n||"#/"),await In(t.token).catch(()=>{})}w.value=Pt()};addEventListener("hashchange",e),addEventListener("popstate",e),await e()}var xe=S(null),X=S(null),D=S(null),E=S(null),M=S([]),V=S([]),pe=new Map,Ft=S(0),fe=S(new Map),Ue=S(null),De=S([]),Z=S("connecting"),J=S([]),ke=S(!1),he=S(null),Wn=S(null),Fe=B(()=>M.value.at(-1)??null),me=B(()=>w.value.step===null),g=B(()=>{let e=M.value;if(!e.length)return null;let t=w.value.step;return t===null?e.at(-1):e[Math.min(Math.max(t-e[0].step,0),e.length-1)]}),te=B(()=>g.value?g.value.step-M.value[0].step:-1),ve=B(()=>(Ft.value,g.value?pe.get(g.value.step)??null:null)),dt=B(()=>{let e=new Map;for(let t of M.value.slice(0,te.value+1)){t.adopted&&e.clear();for(let n of t.drift??[]){let s=`${n.skill} ${n.response}`;e.set(s,{...n,since:e.get(s)?.since??t.step})}}return[...e.values()]}),K=null,ut=[],Ut=!1;function U(e){let{name:t,view:n}=w.value,s=Fe.value?.step;ie(P(t,n,e===null||e>=s?null:Math.max(e,M.value[0]?.step??1)),{replace:!0})}async function Le(){try{xe.value=(await I("/v1/runs?limit=100")).runs,X.value=null}catch(e){X.value=e}}function pt(e="",t=0){K?.close();let n=e?`?mission=${encodeURIComponent(e)}&since=${t}`:"";K=new EventSource(`/v1/events${n}`);let s=K;K.onopen=()=>Z.value=E.value?.phase==="ended"?"over":"live",K.onerror=()=>{s===K&&(Z.value="lost",s.readyState===EventSource.CLOSED&&setTimeout(()=>s===K&&Ds(e),1500))};for(let o of["decision","state","service","progress","bundle","runs"])K.addEventListener(o,i=>{ut.push([o,JSON.parse(i.data)]),Ut||(Ut=!0,document.hidden?setTimeout(Ln,200):requestAnimationFrame(Ln))})}var Ds=e=>e?ft(e,{again:!0}):pt();async function ft(e,{again:t=!1}={}){let n=performance.now(),s=`/v1/missions/${encodeURIComponent(e)}`;t||Hn(),Z.value=t?"lost":"connecting";try{let[o,i]=await Promise.all([I(s),I(`${s}/trace`)]);if(w.value.name!==e)return;ue(()=>{pe.clear(),D.value=o,E.value=o.state??null,ke.value=i.draws,M.value=i.steps.map(Vn),V.value=Gn(M.value),X.value=null,Wn.value=performance.now()-n}),pt(e,i.next),qn(e)}catch(o){X.value=o,t&&setTimeout(()=>w.value.name===e&&ft(e,{again:t}),1500)}}function Hn(){K?.close(),K=null,ut=[],pe.clear(),ue(()=>{D.value=E.value=Ue.value=he.value=Wn.value=null,M.value=V.value=De.value=J.value=[],fe.value=new Map,ke.value=!1})}var zn=()=>Hn();async function qn(e){try{J.value=(await I(`/v1/missions/${encodeURIComponent(e)}/world`)).steps}catch{J.value=[]}}async function Bn(e){if(pe.has(e)||!D.value)return;let{name:t}=w.value;try{let n=await I(`/v1/missions/${encodeURIComponent(t)}/decisions/${e}`);if(w.value.name!==t)return;pe.set(e,n),Ft.value++}catch{}}var Vn=e=>({status:"",surprise:0,...e});function Ln(){Ut=!1;let e=ut;ut=[],ue(()=>{let t=[];for(let[n,s]of e)n==="decision"?t.push(s):n==="state"?Us(s):n==="service"?fe.value=new Map(fe.value).set(s.service,s.is_there):n==="progress"?Ue.value=s:n==="bundle"?De.value=[s,...De.value].slice(0,20):n==="runs"&&(xe.value=s);t.length&&Fs(t)})}function Us(e){if(w.value.name&&e.mission!==w.value.name){e.phase!=="waiting"&&(he.value=e.mission);return}E.value=e,e.phase==="ended"?(Z.value="over",I(`/v1/missions/${encodeURIComponent(e.mission)}`).then(t=>w.value.name===e.mission&&(D.value=t),()=>{}),qn(e.mission)):Z.value==="over"&&(Z.value="live")}function Fs(e){let t=M.value.slice(),n=t.length;for(let{record:s,row:o}of e){let i=Vn(o),r=t.length?i.step-t[0].step:0;if(r<0)continue;let c=t[r];if(c&&c.sequence>=i.sequence)continue;t[r]=c&&s.outcome?{...c,...i,belief:{...c.belief,...i.belief},endings:c.endings,predicted:c.predicted}:i,n=Math.min(n,r);let d={...pe.get(i.step)};d[s.outcome?"observed":"decided"]=s,(d.decided||!s.outcome)&&pe.set(i.step,d),s.outcome&&(Ue.value=null,!J.value.includes(i.step)&&J.value.length&&(J.value=[...J.value,i.step]))}M.value=t,V.value=Gn(t,V.value,n),Ft.value++}function Gn(e,t=[],n=0){let s=t.slice(0,n+(n?1:0));for(let o=s.length?s.length-1:0;o<e.length;o++){let i={...s[o]??{},...e[o].belief??{}};s[o]=i,s[o+1]={...i,...e[o].after??{}}}return s}var L=e=>typeof e=="number"&&Number.isFinite(e);function W(e,t=2){if(!L(e))return"–";let n=Math.abs(e)>=1e3?Math.round(Math.abs(e)).toLocaleString("en"):Math.abs(e).toFixed(t);return`${e<0?"−":"+"}${n}`}var H=(e,t=2)=>L(e)?e.toFixed(t):"–";function O(e){return L(e)?e>.9995&&e<1?">0.999":e<5e-4&&e>0?"<0.001":e.toFixed(3):"–"}function re(e){return L(e)?e>.995&&e<1?">99 %":e<.005&&e>0?"<1 %":`${Math.round(e*100)} %`:"–"}function We(e){return L(e)?e<.001?"<1 ms":e<1?`${Math.round(e*1e3)} ms`:e<60?`${e.toFixed(1)} s`:`${Math.floor(e/60)} min ${Math.round(e%60)} s`:""}function ht(e){let t=new Date(e);if(Number.isNaN(t.getTime()))return"";let n=t.toDateString()===new Date().toDateString(),s=t.toLocaleTimeString([],{hour:"2-digit",minute:"2-digit"});return n?`today, ${s}`:`${t.toLocaleDateString([],{day:"numeric",month:"short"})}, ${s}`}var Ls={goal:"Goal reached",over:"Over, no goal",failure:"Failed",nothing_worthwhile:"Nothing worth doing",too_risky:"Too risky",step_limit:"Step limit",skills_failed:"Skills kept failing",cancelled:"Cancelled",fault:"Fault",not_started:"Not started",stopped:"Stopped",killed:"Killed",running:"Running",unreachable:"Unreachable"},mt=e=>Ls[e]??e,Ws={waiting:"Waiting",building:"Building the model",planning:"Deciding",acting:"Acting",holding:"Holding"},Kn=e=>Ws[e]??e,Q=e=>e.replace(/([(,] ?)\w+=/g,"$1");function Zn(){let e=xe.value,t=(e??[]).filter(s=>s.is_running),n=(e??[]).filter(s=>!s.is_running);return a`<main class="home" id="main">
    <div class="home-list">
      <h1>Missions</h1>
      <${j} problem=${X.value} />
      ${e===null&&!X.value&&a`<p class="empty">Looking for runs…</p>`}
      ${t.length>0&&a`<h2 class="group">Running</h2><ul class="runs">${t.map(s=>a`<${Jn} key=${s.run} run=${s} />`)}</ul>`}
      ${n.length>0&&a`<h2 class="group">Past</h2><ul class="runs">${n.map(s=>a`<${Jn} key=${s.run} run=${s} />`)}</ul>`}
      ${e?.length===0&&a`<div class="welcome">
        <p>No mission has run in this folder yet.</p>
        <p>Start one here, or with <code>aos-up</code> in a terminal: it appears by itself.</p>
      </div>`}
    </div>
    <aside class="home-aside"><${Hs} /></aside>
  </main>`}function Jn({run:e}){let t=e.missions??[],n=t.at(-1)??e.run,s=e.deploy_file?.split("/").at(-1)?.replace(/\.ya?ml$/,"");return a`<li class=${e.is_running?"run is-running":"run"}>
    <a href=${P(n)}>
      <span class="run-name"><b>${e.robot}</b>${s&&s!==e.robot?a`<span class="muted">${s}</span>`:""}</span>
      <span class=${`ending is-${e.ending}`}>${e.is_running&&a`<i class="pulse"></i>`}${mt(e.ending)}</span>
      <span class="run-when muted">${ht(e.started)||e.endpoint}</span>
    </a>
    ${t.length>1&&a`<details><summary>${t.length} missions</summary><ul class="of-run">${t.slice().reverse().map((o,i)=>a`<li><a href=${P(o)}>Mission ${t.length-i}</a></li>`)}</ul></details>`}
  </li>`}function Hs(){let[e,t]=$([]),[n,s]=$(""),[o,i]=$({model:!0,stay:!1,seed:""}),[r,c]=$(null),[d,l]=$(""),p=()=>I("/v1/projects").then(v=>{t(v.projects),s(m=>m||v.projects[0]?.deploy_file||"")},c);k(()=>void p(),[]);async function u(v){v.preventDefault(),l("Starting…"),c(null);try{let m={deploy_file:n,model:o.model,stay:o.stay};o.seed!==""&&(m.seed=Number(o.seed));let _=await oe("/v1/runs",m);await Le(),ie(P(_.mission))}catch(m){c(m)}l("")}async function h(v){let m=v.target.files[0];if(m){l(`Checking ${m.name}…`),c(null);try{let _=await ct("/v1/projects",m);await p(),s(_.deploy_file)}catch(_){c(_)}l(""),v.target.value=""}}let f=(v,m)=>i({...o,[v]:m});return q()?a`<section class="card start" aria-labelledby="start">
    <h2 id="start">New mission</h2>
    <form onSubmit=${u}>
      <label class="field">Project
        <select value=${n} onChange=${v=>s(v.target.value)}>
          ${e.map(v=>a`<option value=${v.deploy_file}>${v.project}${v.is_uploaded?" (uploaded)":""}</option>`)}
          ${!e.length&&a`<option value="">No deploy file in this folder</option>`}
        </select></label>
      <label class="field">Seed <input inputmode="numeric" pattern="[0-9]*" placeholder="that of the file" value=${o.seed} onInput=${v=>f("seed",v.target.value)} /></label>
      <label class="check"><input type="checkbox" checked=${o.model} onChange=${v=>f("model",v.target.checked)} /> Skills are played by their documents; no robot moves</label>
      <label class="check"><input type="checkbox" checked=${o.stay} onChange=${v=>f("stay",v.target.checked)} /> Stay for further missions</label>
      <button class="primary" disabled=${!n||!!d}>Start mission</button>
      <p role="status" class="note">${d}</p>
    </form>
    <hr />
    <label class="button">Upload a bundle…<input type="file" class="visually-hidden" onChange=${h} accept=".zip,.tar,.gz,.tgz,.xz,.bz2" /></label>
    <p class="note">An archive of documents. It is checked first, and played by its own documents.</p>
    <${j} problem=${r} />
  </section>`:a`<section class="card start" aria-labelledby="start"><h2 id="start">New mission</h2>
      <p class="note">Open the address that <code>aos serve</code> prints, to start missions here. Without it this page only reads.</p></section>`}var Lt=S(null),$e=S(""),Xn=()=>q()&&D.value?.is_running&&E.value&&E.value.phase!=="ended",zs=()=>!!E.value?.held_by||E.value?.phase==="holding";async function _e(e,t={}){let{name:n}=w.value;$e.value=e,Lt.value=null;try{let s=await oe(`/v1/missions/${encodeURIComponent(n)}/steering`,{verb:e,...t});w.value.name===n&&(E.value=s)}catch(s){Lt.value=s}$e.value=""}function Qn(){if(he.value)return a`<a class="button primary" href=${P(he.value)}>To the next mission</a>`;if(!D.value?.is_running||!E.value||E.value.phase==="ended")return null;if(!q())return a`<p class="controls note">Read only</p>`;let e=!!$e.value;return a`<div class="controls" role="group" aria-label="Steering">
    ${zs()?a`<button class="primary" disabled=${e} onClick=${()=>_e("resume")}>Go on</button>`:a`<button disabled=${e} onClick=${()=>_e("hold")}>Hold</button>`}
    <button disabled=${e} onClick=${()=>_e("step")} title="One more decision, then hold">Step</button>
    <button class="stop" disabled=${$e.value==="stop"} onClick=${()=>_e("stop")}>${$e.value==="stop"?"Stopping…":"Stop"}</button>
    <${j} problem=${Lt.value} />
  </div>`}var Yn=({action:e})=>Xn()&&a`<span class="of-action">
    <button class="quiet" disabled=${!!$e.value} onClick=${()=>_e("act",{actions:[e]})} aria-label=${`Do ${e}`}>Do</button>
    <button class="quiet" disabled=${!!$e.value} onClick=${()=>_e("leave_out",{name:e})} aria-label=${`Leave out ${e}`}>Leave out</button>
  </span>`;function es(){let e=Object.entries(E.value?.left_out??{}),t=E.value?.asked??[];return!e.length&&!t.length?null:a`<div class="left-out">
    ${t.length>0&&a`<p class="aside">Still to come: ${t.map(n=>a`<span class="chip">${n}</span> `)}</p>`}
    ${e.map(([n,s])=>a`<p class="aside"><span class="chip">${n}</span> is left out by ${s} ${Xn()&&a`<button class="link" onClick=${()=>_e("take_back",{name:n})}>Take it back</button>`}</p>`)}
  </div>`}function ts(){let[e,t]=$(!1),[n,s]=$({belief:"initial",given:"",idle:"0"}),[o,i]=$({}),[r,c]=$(null),[d,l]=$(!1),p=D.value?.run,u=E.value?.phase==="ended";if(k(()=>{!p||!u||!q()||I(`/v1/runs/${encodeURIComponent(p)}`).then(m=>t(m.is_running&&m.stays&&m.missions.at(-1)===E.value?.mission),()=>t(!1))},[p,u]),!e||he.value||!q())return null;let h=Object.entries(D.value?.parameters??{}),f=m=>_=>s({...n,[m]:_.target.value});async function v(m){m.preventDefault(),l(!0),c(null);let _={belief:n.belief,idle:Number(n.idle||0),given:n.given.split(`
`).map(b=>b.trim()).filter(Boolean),values:o};try{ie(P((await oe(`/v1/runs/${encodeURIComponent(p)}/missions`,_)).mission))}catch(b){c(b),l(!1)}}return a`<details class="card next">
    <summary>Next mission</summary>
    <form onSubmit=${v}>
      <label class="field">Belief at the start
        <select value=${n.belief} onChange=${f("belief")}><option value="initial">the initial one</option><option value="keep">the last one of this mission</option></select></label>
      <label class="field">Idle steps before it <input type="number" min="0" max="10000" value=${n.idle} onInput=${f("idle")} /></label>
      ${h.map(([m,_])=>a`<label class="field" key=${m}>${m}
        <input value=${o[m]??_} onInput=${b=>i({...o,[m]:b.target.value})} /></label>`)}
      <label class="field wide">What is known, one expression a line <textarea rows="2" placeholder="state.robot_at == Kitchen" value=${n.given} onInput=${f("given")}></textarea></label>
      <button class="primary" disabled=${d}>${d?"Beginning…":"Begin it"}</button>
    </form>
    <${j} problem=${r} />
  </details>`}var ns=["#4477aa","#ccbb44","#66ccee","#aa3377","#228833","#ee6677","#8a8f98"],qs=new Set(["#ccbb44","#66ccee","#ee6677"]),Bs=new Set(["false","no","none","0"]),Wt=e=>ns[e%ns.length],vt=e=>e.startsWith("var")?"var(--ink)":qs.has(e)?"#14171a":"#ffffff";function ss(e){let t=new Map,n=0;for(let s of e){let o=Bs.has(s.toLowerCase())||s==="…";t.set(s,o?"var(--quiet)":Wt(n++))}return t}var Ht=26,Vs=2,F=(e,t,n=0)=>n+e/Math.max(1,M.value.length)*(t-n),He=e=>e.impossible||e.surprise>=Vs,_t=e=>e.chosen_by==="operator"||e.chosen_by==="script",ze=e=>!!e.status&&e.status!=="observed",Gs=()=>{let e=new Map;for(let t of M.value)e.has(t.skill)||e.set(t.skill,Wt(e.size));return e};function zt({room:e,height:t,head:n=0}){if(te.value<0)return null;let s=F(te.value,e,n),o=F(te.value+1,e,n);return a`<rect class="cursor" x=${s+.75} y="0.75" width=${Math.max(1.5,o-s-1.5)} height=${t-1.5} rx="2" />`}function os(){let[e,t]=z(),n=M.value,s=Gs(),o=g.value;if(!n.length)return a`<div class="timeline" ref=${e}></div>`;let i=n[0].step,r=Fe.value.step;return a`<div class="timeline">
    <div class="timeline-track" ref=${e}>
      <svg width=${t} height=${Ht+12} aria-hidden="true">
        <g transform="translate(0 12)">
          ${t>0&&Ks(n,t,s)}
          <${zt} room=${t} height=${Ht} />
        </g>
        ${t>0&&Js(n,t)}
      </svg>
      <input type="range" min=${i} max=${r} step="1" value=${o.step}
        aria-label="Step" aria-valuetext=${`step ${o.step}, ${o.action}`}
        onInput=${c=>U(Number(c.target.value))} />
    </div>
    <div class="timeline-foot">
      <ul class="legend" aria-label="Skills">
        ${[...s].map(([c,d])=>a`<li><i style=${{background:d}}></i>${c}</li>`)}
        ${n.some(He)&&a`<li><svg width="10" height="9" aria-hidden="true"><path class="surprise" d="M5 0 l5 9 h-10z" /></svg>surprise</li>`}
        ${n.some(ze)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="failed" d="M1 1 l7 7 M8 1 l-7 7" /></svg>not observed</li>`}
        ${n.some(_t)&&a`<li><svg width="9" height="9" aria-hidden="true"><rect class="asked" x="1" y="1" width="7" height="7" rx="1" /></svg>asked for by a person</li>`}
        ${n.some(c=>c.adopted)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="adopted" d="M4.5 0 l4.5 4.5 l-4.5 4.5 l-4.5 -4.5z" /></svg>new model</li>`}
      </ul>
      <div class="stepper">
        <button class="quiet" onClick=${()=>U(o.step-1)} disabled=${o.step<=i} aria-label="Step before">‹</button>
        <span class="stepper-place"><b>${o.step}</b> of ${r}</span>
        <button class="quiet" onClick=${()=>U(o.step+1)} disabled=${o.step>=r} aria-label="Step after">›</button>
        <button class=${`quiet newest ${me.value?"is-on":""}`} aria-pressed=${me.value} onClick=${()=>U(null)}>
          ${E.value?.phase==="ended"?"Last":"Newest"}</button>
      </div>
    </div>
  </div>`}function Ks(e,t,n){let s=F(1,t)-F(0,t),o=s>6?2:0,i=[];for(let r=0;r<e.length;){let c=r+1;if(!o)for(;c<e.length&&e[c].skill===e[r].skill;)c++;let d=n.get(e[r].skill),l=Math.max(1,(c-r)*s-o),p=Q(e[r].action),u=!e[r].status;i.push(a`<rect class=${u?"open":""} x=${F(r,t)} y="0" width=${l} height=${Ht} rx="2" style=${{fill:d,stroke:u?d:"none"}} />`),l>p.length*7.2+12&&i.push(a`<text x=${F(r,t)+6} y="17" style=${{fill:u?"var(--ink)":vt(d)}}>${p}</text>`),r=c}return i}function Js(e,t){return e.map((n,s)=>{let o=F(s+.5,t);return[He(n)&&a`<path class="surprise" d=${`M${o} 1 l4.5 8 h-9z`}><title>${`step ${n.step}: surprise ${n.impossible?"without end":H(n.surprise)}, expected with ${O(n.expected)}`}</title></path>`,ze(n)&&a`<path class="failed" d=${`M${o-3.5} 2 l7 7 M${o+3.5} 2 l-7 7`} />`,_t(n)&&a`<rect class="asked" x=${F(s+.5,t)-(He(n)||ze(n)?12:3.5)} y="2" width="7" height="7" rx="1" />`,n.adopted&&a`<path class="adopted" d=${`M${F(s,t)} 1 l4 4 l-4 4 l-4 -4z`} />`]})}function is(){let e=g.value;return e?a`<div class="decision">
    <p class="sentence"><span class="action">${e.action}</span> ${Zs(e)}</p>
    <p class="came">${Xs(e)}</p>
    ${e.fault&&a`<p class="came fault">${e.fault}</p>`}
    ${e.remark&&a`<p class="came">${e.remark}</p>`}
    ${e.adopted&&a`<p class="came">A new model decided: ${e.adopted}.</p>`}
  </div>`:a`<p class="sentence muted">${E.value?.remark?`${E.value.remark}.`:"No decision has been made yet."}</p>`}function Zs(e){let t=[e.planner,e.simulations?`${e.simulations.toLocaleString("en")} simulations`:"",We(e.planning_s)].filter(Boolean).join(", "),n=t&&a`<span class="by">${t}</span>`;if(_t(e))return e.chosen_by==="script"?a`comes from a script of a person.`:a`was asked for by a person.`;if(!L(e.value))return a`was chosen. ${n}`;let s=a`is worth <b>${W(e.value)}</b>${e.error>=.005?` ± ${H(e.error)}`:""}`;if(!e.second)return a`${s}; nothing else can be done. ${n}`;let o=Math.hypot(e.error??0,e.second_error??0),i=a`<span class="other">${e.second}</span>`;return L(e.margin)&&Math.abs(e.margin)<2*o?a`${s}, too close to call against ${i}. ${n}`:e.margin<0?a`${s}, ${H(-e.margin)} less than ${i}. ${n}`:e.margin===0?a`${s}, as much as ${i}. ${n}`:a`${s}, <b>${H(e.margin)}</b> more than ${i}. ${n}`}function Xs(e){let n=Object.entries(e.predicted??{}).sort((i,r)=>r[1]-i[1]).slice(0,3).map(([i,r],c)=>a`${c?", ":""}<span class="response">${i}</span> ${re(r)}`);if(!e.status){let i=Ue.value;return a`Expected ${n}. ${i&&i.id?.step===e.step?`${i.state}${i.progress?`, ${re(i.progress)}`:""}${i.text?`: ${i.text}`:""}`:a`<span class="waiting">It is running.</span>`}`}if(e.status!=="observed")return a`Expected ${n}. Nothing was observed: <b>${e.status.replace("_"," ")}</b>.`;let s=e.impossible?"The model held that impossible.":`Surprise ${H(e.surprise)}.`,o=e.stopped_by?` It was stopped by ${e.stopped_by}.`:"";return a`Expected ${n}. Saw <b class="response">${e.seen}</b>${L(e.expected)?` (${O(e.expected)})`:""}.${o} ${s}`}var ne=40,qt=8,Qs=12,Ys=.2;function as(){let[e,t]=z(),[n,s]=$(!1),o=V.value,i=Vt(o),r=i.filter(p=>p.isDoubtful||p.isMoving),c=n?r:r.slice(0,qt),d=i.filter(p=>!p.isDoubtful&&!p.isMoving),l=te.value;return a`<div class="ribbons" ref=${e}>
    ${t>0&&c.map(p=>a`<${eo} key=${p.name} row=${p} all=${o} size=${t} now=${l} />`)}
    ${r.length>qt&&a`<button class="link" onClick=${()=>s(!n)}>
      ${n?"Show fewer":`Show ${r.length-qt} more`}</button>`}
    ${d.length>0&&a`<p class="still"><span>Certain throughout</span>
      ${d.slice(0,40).map(p=>a`<span class="chip"><b>${p.name}</b> ${p.values[0]}</span>`)}</p>`}
    ${!i.length&&a`<p class="empty">There is no belief yet.</p>`}
  </div>`}function eo({row:e,all:t,size:n,now:s}){let o=Ie.value<720,i=Math.max(60,o?n:n-330),r=$t(i),c=ss(e.values),d=t[s+1]?.[e.name]??{},l=Object.entries(d).sort((u,h)=>h[1]-u[1]),p=l.slice(0,2).map(([u,h])=>`${u} ${O(h)}`).join(", ");return a`<div class="ribbon">
    <h3 class="ribbon-name">${e.name}</h3>
    <svg class=${i>4*t.length?"ribbon-plot":"ribbon-plot is-dense"} width=${i} height=${ne} role="img" aria-label=${`${e.name}: ${p}`}
      onClick=${u=>U(to(u,i))}>
      ${no(e,t,i,c)}
      ${e.moves.length<=Qs&&e.moves.map(u=>a`<path class="moved" d=${`M${F(u-1,i,r)} ${ne} l-3.5 5 h7 z`} />`)}
      ${so(e,t,i,c)}
      <${zt} room=${i} height=${ne} head=${r} />
    </svg>
    <dl class="ribbon-now">
      ${l.slice(0,2).map(([u,h])=>a`<div><dt><i style=${{background:c.get(u)}}></i>${u}</dt><dd>${O(h)}</dd></div>`)}
    </dl>
  </div>`}var $t=e=>Math.min(24,e/(M.value.length+.5)*.5),to=(e,t)=>{let n=M.value.length,s=e.clientX-e.currentTarget.getBoundingClientRect().left,o=$t(t),i=Math.min(n-1,Math.max(0,Math.floor((s-o)/(t-o)*n)));return M.value[i]?.step};function no(e,t,n,s){let o=t.length-1;if(o<1)return null;let i=$t(n),r=Math.min(8,n/o*.4),c=new Float64Array(t.length);return e.values.map(d=>{let l="",p="",u=!1;for(let h=0;h<=o;h++){let f=t[h][e.name]?.[d]??0;f>0&&(u=!0);let v=ne-c[h]*ne;c[h]+=f;let m=ne-c[h]*ne,_=h===0?0:F(h-1,n,i)+r/2,b=h===o?n:Math.max(_,F(h,n,i)-r/2);l+=`${l?"L":"M"}${_.toFixed(1)} ${m.toFixed(1)}L${b.toFixed(1)} ${m.toFixed(1)}`,p=`L${b.toFixed(1)} ${v.toFixed(1)}L${_.toFixed(1)} ${v.toFixed(1)}${p}`}return u?a`<path d=${`${l}${p}Z`} style=${{fill:s.get(d)}} />`:null})}function so(e,t,n,s){let o=[],i=t.length-1,r=$t(n),c=0,d=null,l=p=>{let u=c===0?0:F(c-1,n,r),h=p>i?n:F(p-1,n,r);if(!d||h-u<d.length*7+14)return;let f=0,v=t[c][e.name]??{};for(let _ of e.values){if(_===d)break;f+=v[_]??0}let m=ne-(f+(v[d]??0)/2)*ne;o.push(a`<text x=${u+8} y=${m+4} style=${{fill:vt(s.get(d))}}>${d}</text>`)};for(let p=0;p<=i;p++){let[u,h]=Object.entries(t[p][e.name]??{}).reduce((v,m)=>m[1]>v[1]?m:v,["",0]),f=h>=.5?u:null;f!==d&&(l(p),c=p,d=f)}return l(i+1),o}var Bt={all:null,rows:[]};function Vt(e){if(Bt.all===e)return Bt.rows;let t=new Map;for(let s=0;s<e.length;s++)for(let o in e[s]){let i=e[s][o],r=s?e[s-1][o]:void 0,c=t.get(o);c||t.set(o,c={name:o,weights:new Map,doubt:0,isDoubtful:!1,isMoving:!1,moves:[]});let d=0;for(let l in i){let p=i[l];c.weights.set(l,(c.weights.get(l)??0)+p),p>0&&p<1&&(d-=p*Math.log(p))}if(d>.005&&(c.isDoubtful=!0),c.doubt+=d,r&&r!==i){let l=io(r,i);l>1e-4&&(c.isMoving=!0),l>=Ys&&c.moves.push(s)}}let n=[...t.values()].map(s=>({...s,values:[...s.weights.entries()].sort(oo).map(([o])=>o)}));return n.sort((s,o)=>o.doubt-s.doubt||o.moves.length-s.moves.length),Bt={all:e,rows:n},n}var rs=e=>e==="true"?-1:e==="false"||e==="…"?1:0,oo=(e,t)=>rs(e[0])-rs(t[0]);function io(e,t){let n=0;for(let s in e)n+=Math.abs(e[s]-(t[s]??0));for(let s in t)s in e||(n+=t[s]);return n/2}var ls=8,ro=30;function cs(){let[e,t]=z(),[n,s]=$(!1),o=ve.value?.decided??ve.value?.observed;if(!g.value||!o||o.step!==g.value.step)return a`<div ref=${e} class="values" aria-busy="true"></div>`;let i=o.actions.filter(l=>L(l.q)).sort((l,p)=>p.q-l.q),r=n?i:i.slice(0,ls),c=i.find(l=>l.action===o.action);c&&!r.includes(c)&&(r=[...r,c]);let d=lo(r);return a`<div class="values" ref=${e}>
    <ol>
      ${r.map(l=>a`<${ao} key=${l.action} each=${l} scale=${d} size=${t} found=${o} />`)}
    </ol>
    ${i.length>ls&&a`<button class="link" onClick=${()=>s(!n)}>${n?"Show fewer":`Show all ${i.length}`}</button>`}
    ${!i.length&&a`<p class="empty">${o.planner?`${o.planner} gives no values.`:"There are no values."}</p>`}
    ${Object.entries(o.set_aside??{}).map(([l,p])=>a`<p class="aside"><b>${l}</b> is set aside: ${p}</p>`)}
    ${(o.constraints??[]).map(l=>a`<p class="aside">Never <code>${l.never}</code>: risks ${l.risk.toPrecision(2)} of ${l.left.toPrecision(2)} that are left.</p>`)}
  </div>`}function ao({each:e,scale:t,size:n,found:s}){let o=e.action===s.action,i=Math.max(80,n-(Ie.value<480?84:92)),r=l=>t(l)*(i-16)+8,c=e.stderr??0,d=`${e.action}: ${W(e.q)}${c>=.005?` ± ${c.toFixed(2)}`:""}${o?", chosen":""}`;return a`<li class=${o?"value is-chosen":"value"} aria-label=${d}>
    <span class="value-head"><span class="value-name" title=${e.action}>${o&&a`<span class="chosen-mark" aria-hidden="true">▸</span>`}${Q(e.action)}</span><${Yn} action=${e.action} /></span>
    <span class="value-plot">
      <svg width=${i} height=${ro-12} aria-hidden="true">
        <line class="rail" x1="8" x2=${i-8} y1="9" y2="9" />
        ${L(e.at_least)&&L(e.at_most)&&a`<line class="proven" x1=${r(e.at_least)} x2=${r(e.at_most)} y1="9" y2="9" />`}
        ${c>0&&a`<line class="error" x1=${r(e.q-2*c)} x2=${r(e.q+2*c)} y1="9" y2="9" />`}
        <circle cx=${r(e.q)} cy="9" r=${o?5.5:4} />
      </svg>
      <span class="value-number">${W(e.q)}</span>
    </span>
  </li>`}function lo(e){let t=e.flatMap(o=>[o.q-2*(o.stderr??0),o.q+2*(o.stderr??0)]).filter(L),n=Math.min(...t),s=Math.max(...t)-n||1;return o=>Math.min(1,Math.max(0,(o-n)/s))}var Gt=new Map,us=e=>e.margin<0?e.action:e.other,co=e=>({operator:", which an operator has asked for",script:", which a script has asked for"})[e.chosen_by]??"";function ds(){let[e,t]=$(""),[n,s]=$(null),[o,i]=$(null),r=g.value?.step,{name:c}=w.value;if(k(()=>t(""),[c,r]),k(()=>{if(!r)return;let l=`/v1/missions/${encodeURIComponent(c)}/decisions/${r}/why?instead=${encodeURIComponent(e)}`;if(i(null),s(Gt.get(l)??null),Gt.has(l))return;let p=!0,u=setTimeout(()=>I(l).then(h=>{g.value?.status&&Gt.set(l,h),p&&s(h)},h=>p&&i(h)),150);return()=>{p=!1,clearTimeout(u)}},[c,r,e]),!r)return a`<p class="empty">There is no decision yet.</p>`;let d=(ve.value?.decided?.actions??[]).map(l=>l.action).filter(l=>l!==g.value.action);return a`<div class="why" aria-busy=${!n&&!o}>
    <p class="why-head">Why <span class="action">${g.value.action}</span>${n&&co(n)}
      <label> and not <select value=${e} onChange=${l=>t(l.target.value)}>
        <option value="">the runner-up${n&&!e?`, ${n.other}`:""}</option>
        ${d.map(l=>a`<option value=${l}>${l}</option>`)}
      </select></label></p>
    <${j} problem=${o} />
    ${!n&&!o&&a`<p class="empty">An engine of its own is brought to this step…</p>`}
    ${n&&a`<${uo} why=${n} />`}
    ${r&&a`<${vo} key=${`${c} ${r}`} name=${c} step=${r} />`}
  </div>`}var uo=({why:e})=>a`<div class="columns even">
  <${C} id="margin" title="Where the margin comes from" note=${po(e)}><${fo} why=${e} /><//>
  <div class="stack">
    <${C} id="flips" title="At which belief the choice changes" note=${e.flips?.length?"Coloured: the action that is better now. Grey: the other one. The line is the belief now.":""}><${ho} why=${e} /><//>
    <${C} id="leads" title="What each response leads to"><${mo} why=${e} /><//>
  </div>
</div>`;function po(e){if(e.is_close){let n=e.simulations_to_tell?`about ${e.simulations_to_tell.toLocaleString("en")} simulations would tell`:"no number of simulations is sure to tell";return`Too close to call against ${e.other}: ${n}.`}let t=e.margin_stderr>=.005?` ± ${H(e.margin_stderr)}`:"";return`${W(e.margin)}${t} over ${e.other}, ${e.is_exact?"exactly":`by ${e.planner}`}.`}function fo({why:e}){let[t,n]=z(),s=(e.terms??[]).map(l=>({...l,margin:l.value-l.other})).filter(l=>Math.abs(l.margin)>5e-4),o=(e.rest??0)-(e.other_rest??0);Math.abs(o)>5e-4&&s.push({place:"later steps",margin:o});let i=Math.max(...s.map(l=>Math.abs(l.margin)),1e-9),r=Math.max(80,n-(n<420?190:250)),c=l=>r/2+l/i*(r/2-2),d=P(w.value.name,"documents",w.value.step);return a`<div class="terms" ref=${t}>
    ${!s.length&&a`<p class="empty">${e.remark||"No line of the documents tells them apart."}</p>`}
    <ul>${s.slice(0,12).map(l=>a`<li aria-label=${`${W(l.margin,3)} from ${l.place}`}>
      <span class="term-place">${l.place==="later steps"?l.place:a`<a href=${d}>${l.place}</a>`}</span>
      <svg width=${r} height="18" aria-hidden="true">
        <line class="rail" x1=${r/2} x2=${r/2} y1="0" y2="18" />
        <rect class=${l.margin>0?"for":"against"} x=${Math.min(c(0),c(l.margin))} y="4" width=${Math.max(1,Math.abs(c(l.margin)-c(0)))} height="10" rx="2" />
      </svg>
      <span class="number">${W(l.margin,2)}</span>
    </li>`)}</ul>
    ${e.remark&&s.length>0&&a`<p class="aside">${e.remark}</p>`}
  </div>`}function ho({why:e}){let[t,n]=z(),s=Math.max(100,n),o=r=>r*s,i=(e.flips??[]).slice(0,5);return a`<div class="flips" ref=${t}>
    ${!i.length&&a`<p class="empty">${e.remark||`No probability of one value makes ${us(e)} better.`}</p>`}
    ${i.map(r=>{let c=(r.low+r.high)/2>r.now,[d,l]=c?[r.high,1]:[0,r.low],p=c?"above":"below",u=r.high-r.low>.001?`${p} a probability between ${O(r.low)} and ${O(r.high)}`:`${p} ${O((r.low+r.high)/2)}`;return a`<figure class="flip">
        <figcaption>P(<span class="code">${r.variable} = ${r.value}</span>) is ${O(r.now)}; ${Q(us(e))} wins ${u}${r.is_checked?"":", not checked by planning"}</figcaption>
        <svg width=${s} height="22" aria-hidden="true">
          <rect class="this" x="0" y="3" width=${s} height="16" rx="3" />
          <rect class="between" x=${o(r.low)} y="3" width=${Math.max(1,o(r.high)-o(r.low))} height="16" />
          <rect class="other" x=${o(d)} y="3" width=${Math.max(1,o(l)-o(d))} height="16" rx="3" />
          <line class="now" x1=${o(r.now)} x2=${o(r.now)} y1="0" y2="22" />
        </svg>
      </figure>`})}
  </div>`}var mo=({why:e})=>a`<ul class="leads">
  ${(e.expected??[]).map(t=>a`<li class=${t.is_seen?"is-seen":""}>
    <p><span class="response">${t.response}</span> <span class="muted">${re(t.probability)}</span>${t.is_seen&&a` <b>seen</b>`}</p>
    <p class="muted">${t.action?a`goal ${O(t.goal_probability??0)}; next would be <span class="response">${t.action}</span>, worth ${W(t.value)}`:`goal ${O(t.goal_probability??0)}; the mission would be over`}</p>
  </li>`)}
</ul>`;function vo({name:e,step:t}){let[n,s]=$({forbid:"",without:"",believe:"",change:""}),[o,i]=$(null),[r,c]=$(null),[d,l]=$(!1);if(!q())return null;let p=[["forbid","Without this action now",g.value?.action??""],["without","Without this skill for good",g.value?.skill??""],["believe","With another belief","variable=value:0.5"],["change","With another number in the documents","file:line=number"]];async function u(h){h.preventDefault(),l(!0),c(null);let f={};for(let[v]of p)n[v].trim()&&(f[v]=[n[v].trim()]);try{i(await oe(`/v1/missions/${encodeURIComponent(e)}/decisions/${t}/whatif`,f))}catch(v){i(null),c(v)}l(!1)}return a`<${C} id="whatif" title="What if" className="whatif" note="The step is decided anew; the mission is not touched.">
    <form onSubmit=${u}>
      ${p.map(([h,f,v])=>a`<label class="field">${f}<input value=${n[h]} placeholder=${v} onInput=${m=>s({...n,[h]:m.target.value})} /></label>`)}
      <button class="primary" disabled=${d}>${d?"Deciding…":"Decide anew"}</button>
    </form>
    <div role="status">${o&&a`<p class="supposed">${o.action===o.before?"Still ":"Then "}<b class="action">${o.action}</b>, worth <b>${W(o.value)}</b>${o.action===o.before?"":a`, in place of ${o.before} with ${W(o.value_before)}`}.</p>
      ${(o.supposed??[]).map(h=>a`<p class="muted">Supposed: ${h}</p>`)}
      ${o.remark&&a`<p class="muted">${o.remark}</p>`}`}</div>
    <${j} problem=${r} />
  <//>`}var fs=()=>a`<div class="columns even">
  <${_o} />
  <${C} id="expected" title="Expected against seen" note="The ring is how often the model expected a response, the dot how often it came; the bar holds the true frequency with 95 %.">
    <${bo} />
  <//>
  <${C} id="strip" title="Decision strip" note="What was chosen at which probability, in this mission. The larger a dot, the more often.">
    <${yo} />
  <//>
</div>`;function _o(){let e=dt.value;return e.length?a`<${C} id="alarms" title="The model does not hold" className="alarms" note="Where the model is right, the probability that any such alarm ever comes is 1 % at most.">
    <div class="scroll" tabindex="0" role="region" aria-label="Table of alarms"><table>
      <thead><tr><th>Skill</th><th>Response</th><th class="num">Modelled</th><th class="num">Seen</th><th class="num">Uses</th><th class="num" title="The step at which it began">Since</th></tr></thead>
      <tbody>${e.map(t=>a`<tr onClick=${()=>U(t.since)}>
        <td class="action">${t.skill}</td><td class="response">${t.response}</td>
        <td class="num">${H(t.modelled)}</td><td class="num mark">${H(t.seen)}</td><td class="num">${t.uses}</td>
        <td class="num"><button class="row-step" aria-label=${`Step ${t.since}`}>${t.since}</button></td>
      </tr>`)}</tbody>
    </table></div>
  <//>`:null}function $o(){let e=new Map;for(let t of M.value){if(t.status!=="observed")continue;e.has(t.skill)||e.set(t.skill,{uses:0,responses:new Map});let n=e.get(t.skill);n.uses++;let s=new Set([...Object.keys(t.predicted??{}),t.seen]);for(let o of s){let i=n.responses.get(o)??{expected:0,seen:0};i.expected+=t.predicted?.[o]??0,o===t.seen&&i.seen++,n.responses.set(o,i)}}return e}function go(e,t){let s=e/t,o=(s+1.96*1.96/(2*t))/(1+1.96*1.96/t),i=1.96*Math.sqrt(s*(1-s)/t+1.96*1.96/(4*t*t))/(1+1.96*1.96/t);return[Math.max(0,o-i),Math.min(1,o+i)]}function bo(){let[e,t]=z(),n=$o(),s=Math.max(90,t-(t<480?132:250)),o=i=>8+i*(s-16);return a`<div class="expected" ref=${e}>
    ${!n.size&&a`<p class="empty">Nothing has been observed yet.</p>`}
    ${[...n].map(([i,{uses:r,responses:c}])=>a`<div class="skill" key=${i}>
      <h3>${i} <span class="muted">${r} ${r===1?"use":"uses"}</span></h3>
      <ul>${[...c].sort((d,l)=>l[1].seen-d[1].seen).map(([d,{expected:l,seen:p}])=>{let[u,h]=go(p,r),f=l/r,v=f<u||f>h;return a`<li class=${v?"is-off":""} aria-label=${`${d}: expected ${re(f)}, seen ${re(p/r)}, ${p} of ${r}${v?", outside of the interval":""}`}>
          <span class="response-name">${d}</span>
          <svg width=${s} height="18" aria-hidden="true">
            <line class="rail" x1="8" x2=${s-8} y1="9" y2="9" />
            <line class="error" x1=${o(u)} x2=${o(h)} y1="9" y2="9" />
            <circle class="ring" cx=${o(f)} cy="9" r="5.5" />
            <circle class="dot" cx=${o(p/r)} cy="9" r="3.5" />
          </svg>
          <span class="number">${p}/${r}${v?a` <b title="The model's frequency is outside of the interval">!</b>`:""}</span>
        </li>`})}</ul>
    </div>`)}
  </div>`}function yo(){let[e,t]=z(),[n,s]=$(""),i=Vt(V.value).filter(m=>m.isDoubtful).flatMap(m=>m.values.filter(_=>_!=="…"&&!(_==="false"&&m.values.includes("true"))).map(_=>`${m.name} = ${_}`)),r=i.includes(n)?n:i[0];if(!r)return a`<div ref=${e}><p class="empty">No variable is in doubt.</p></div>`;let[c,d]=r.split(" = "),l=new Map;M.value.forEach((m,_)=>{let b=V.value[_]?.[c]?.[d]??0;l.has(m.action)||l.set(m.action,[]),l.get(m.action).push({share:b,step:m})});let p=28,u=t<480,h=Math.max(120,t-(u?120:190)),f=m=>10+m*(h-20),v=[...l].sort((m,_)=>ps(m[1])-ps(_[1])).slice(0,14);return a`<div class="strip" ref=${e}>
    <label class="pick">Probability of <select value=${r} onChange=${m=>s(m.target.value)}>
      ${i.map(m=>a`<option value=${m}>${m}</option>`)}</select></label>
    <div class="strip-rows">
      ${v.map(([m,_])=>a`<div class="strip-row" key=${m}>
        <span class="value-name" title=${m}>${Q(m)}</span>
        <svg width=${h} height=${p} role="img" aria-label=${`${m}: chosen at ${_.slice(0,12).map(b=>O(b.share)).join(", ")}`}>
          <line class="rail" x1="10" x2=${h-10} y1=${p/2} y2=${p/2} />
          ${wo(_).map(({share:b,at:y})=>a`<circle class=${y.includes(g.value)?"is-now":""} cx=${f(b)} cy=${p/2} r=${Math.min(12,3.5+1.5*Math.sqrt(y.length))} onClick=${()=>U(y[0].step)}><title>${`${O(b)}: ${y.length>1?`${y.length} steps`:`step ${y[0].step}`}`}</title></circle>`)}
        </svg>
      </div>`)}
      <div class="strip-row axis" aria-hidden="true"><span></span><span class="axis-ends" style=${{width:`${h}px`}}><i>0</i><i>½</i><i>1</i></span></div>
    </div>
  </div>`}function wo(e){let t=new Map;for(let{share:n,step:s}of e){let o=Math.round(n*100);t.has(o)||t.set(o,{share:n,at:[]}),t.get(o).at.push(s)}return[...t.values()]}var ps=e=>e.reduce((t,n)=>t+n.share,0)/e.length;var hs=()=>a`<div class="columns">
  <${C} id="all-steps" title="Steps" className="wide"><${Kt} /><//>
  <${C} id="activation" title=${g.value?`Activation of step ${g.value.step}`:"Activation"}><${ko} /><//>
</div>`,gt=150;function Kt(){let e=ce(null),[t,n]=$(!1),s=g.value?.step,o=M.value,i=o.length>gt&&!t,r=i?Math.max(0,Math.min(o.length-gt,Math.round((te.value-gt/2)/25)*25)):0,c=i?o.slice(r,r+gt):o;return k(()=>{let d=e.current?.querySelector("[aria-selected=true]"),l=e.current?.closest(".scroll");d&&l&&(d.offsetTop<l.scrollTop+30||d.offsetTop+d.offsetHeight>l.scrollTop+l.clientHeight)&&(l.scrollTop=d.offsetTop-l.clientHeight/2)},[s]),a`<div class="scroll" tabindex="0" role="region" aria-label="Table of steps">
    <table class="steps">
      <thead><tr><th>Step</th><th>Action</th><th class="num wide-only">Value</th><th>Seen</th><th class="num wide-only">Expected</th><th class="num">Surprise</th><th class="num wide-only">Goal</th></tr></thead>
      <tbody ref=${e}>${c.map(d=>a`<${xo} key=${d.step} step=${d} isNow=${d.step===s} />`)}</tbody>
    </table>
    ${i&&a`<button class="link" onClick=${()=>n(!0)}>Show all ${o.length} steps</button>`}
  </div>`}var xo=({step:e,isNow:t})=>a`<tr aria-selected=${t} onClick=${()=>U(e.step)}>
  <td><button class="row-step" aria-label=${`Step ${e.step}`}>${e.step}</button></td>
  <td class="action" title=${e.action}>${Q(e.action)}</td>
  <td class="num wide-only">${W(e.value)}</td>
  <td>${e.status?ze(e)?a`<span class="bad">✕ ${e.status.replace("_"," ")}</span>`:e.seen:a`<span class="muted">running</span>`}</td>
  <td class="num wide-only">${e.status?O(e.expected):""}</td>
  <td class="num">${e.status?a`${He(e)?a`<span class="mark" aria-label="surprising">▲ </span>`:""}${e.impossible?"∞":H(e.surprise)}`:""}</td>
  <td class="num wide-only">${O((e.endings_after??e.endings)?.goal)}</td>
</tr>`;function ko(){let e=ve.value,t=g.value;if(!t||!e)return a`<p class="empty">There is no step yet.</p>`;let n=e.observed??e.decided,s=e.observed?.outcome,o=s?(s.ended_ns-s.started_ns)/1e9:null,i=Object.entries(s?.local_variables??{});return a`<div class="activation">
    <p class="big-action">${t.action}</p>
    <dl class="facts">
      <div><dt>Outcome</dt><dd>${s?`${s.status.replace("_"," ")}${s.response?`: ${s.response}`:""}`:"running"}</dd></div>
      ${o!==null&&a`<div><dt>Took</dt><dd>${We(o)}</dd></div>`}
      <div><dt>Decided in</dt><dd>${We(n.planning_s)}${n.planner?`, by ${n.planner}`:""}</dd></div>
      ${n.why&&a`<div><dt>Why this planner</dt><dd>${n.why}</dd></div>`}
      <div><dt>Look-ahead</dt><dd>${n.horizon} decisions</dd></div>
      <div><dt>Model</dt><dd>revision ${n.revision}, <code>${n.model_digest.slice(0,12)}</code></dd></div>
      <div><dt>Belief</dt><dd>${n.belief.states.toLocaleString("en")} ${n.belief.states===1?"state":"states"}, ${n.belief.is_exact?"exact":"sampled"}</dd></div>
      ${Object.entries(s?.numbers??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${JSON.stringify(c)}</dd></div>`)}
      ${Object.entries(s?.monitors??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}
    </dl>
    <h3>Local variables</h3>
    ${i.length?a`<dl class="facts mono">${i.map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}</dl>`:a`<p class="empty">${s?"The mapping has none.":"They come with the outcome."}</p>`}
  </div>`}function ms(){let[e,t]=$(null),[n,s]=$(null),[o,i]=$(""),r=g.value,c=r?.revision??0,{name:d}=w.value;if(k(()=>{let f=!0;return I(`/v1/missions/${encodeURIComponent(d)}/documents?revision=${c}`).then(v=>f&&(t(v),s(null)),v=>f&&s(v)),()=>f=!1},[d,c,!!D.value]),k(()=>i(""),[r?.skill]),n)return a`<${j} problem=${n} />`;if(!e)return a`<p class="empty">Reading the documents…</p>`;let l=(e.skills[r?.skill]??[]).filter(f=>f.what==="model"||f.what===`rule ${r?.seen}`),p=o||l[0]?.file||e.files[0]?.name,u=e.files.find(f=>f.name===p)?.text??"",h=l.map(f=>f.file);return a`<${C} id="documents" title=${`Documents of ${e.project}`} note=${`Revision ${e.revision}${r?`; the lines of ${r.skill} are marked`:""}.`}>
    <div class="files" role="tablist" aria-label="Files">
      ${e.files.map(f=>a`<button role="tab" aria-selected=${f.name===p} class=${h.includes(f.name)?"is-about":""} onClick=${()=>i(f.name)}>${f.name}</button>`)}
    </div>
    <${So} key=${p} text=${u} marked=${l.filter(f=>f.file===p)} />
  <//>`}function So({text:e,marked:t}){let n=ce(null);return k(()=>{let s=n.current?.querySelector(".is-marked");s&&(n.current.scrollTop=Math.max(0,s.offsetTop-60))},[t.map(s=>s.first).join()]),a`<pre class="source" ref=${n} tabindex="0"><code>${e.split(`
`).map((s,o)=>{let i=t.find(r=>r.first<=o+1&&o+1<=r.last);return a`<span class=${i?"line is-marked":"line"} data-line=${o+1}>${s||" "}\n</span>`})}</code></pre>`}function vs(){let[e,t]=$(null),{name:n}=w.value,s=g.value?.step,o=!!g.value?.status;return k(()=>{if(!ke.value||!s)return;let i=!0,r=l=>i&&t(l),c=`/v1/missions/${encodeURIComponent(n)}/decisions/${s}/picture`,d=setTimeout(()=>Dn(c).then(l=>r({step:s,url:URL.createObjectURL(l)}),l=>r({step:s,problem:l})),150);return()=>{i=!1,clearTimeout(d)}},[n,s,o,ke.value]),k(()=>()=>e?.url&&URL.revokeObjectURL(e.url),[e]),ke.value?a`<${C} id="drawn" title="State" note="The likeliest value of each variable, as the bundle draws it.">
    <${j} problem=${e?.problem} />
    ${e?.url&&a`<figure class="picture"><img src=${e.url} alt=${`The state after step ${e.step}`} /></figure>`}
  <//>`:null}function _s(){let e=D.value,[t,n]=$(null),[s,o]=$(null),[i,r]=$([]),[c,d]=$(""),[l,p]=$(""),[u,h]=$(null),f=e&&encodeURIComponent(e.run);k(()=>{f&&(I(`/v1/runs/${f}`).then(n,h),I(`/v1/runs/${f}/services`).then(o,h),I(`/v1/runs/${f}/bundles`).then(_=>r(_.entries),()=>r([])))},[f,De.value.length,fe.value.size]);let v=s?.services.find(_=>_.service==="solver")?.service??s?.services[0]?.service,m=c||v;return k(()=>{if(!f||!m)return;let _=()=>Un(`/v1/runs/${f}/logs/${m}?tail=60000`).then(p,h);_();let b=e.is_running?setInterval(_,2e3):null;return()=>clearInterval(b)},[f,m,e?.is_running]),e?a`<div class="columns">
    <${C} id="logs" title="Logs" className="wide">
      <div class="files" role="tablist" aria-label="Processes">
        ${(s?.services??[]).map(_=>a`<button role="tab" aria-selected=${_.service===m} onClick=${()=>d(_.service)}>
          ${e.is_running&&a`<i class=${`presence ${fe.value.get(_.service)?"is-there":""}`} title=${fe.value.get(_.service)?"on the bus":"not on the bus"}></i>`}${_.service}</button>`)}
      </div>
      <pre class="source log" tabindex="0" aria-label=${`Log of ${m}`}>${l||"The log is empty."}</pre>
      <${j} problem=${u} />
    <//>
    <div class="stack">
      <${C} id="run" title="Run">
        ${t&&a`<dl class="facts">
          <div><dt>Robot</dt><dd>${t.robot}</dd></div>
          <div><dt>Started</dt><dd>${ht(t.started)}</dd></div>
          <div><dt>Deploy file</dt><dd class="path">${t.deploy_file}</dd></div>
          <div><dt>Directory</dt><dd class="path">${t.directory}</dd></div>
          <div><dt>Seed</dt><dd>${e.mission?.seed??t.seed}</dd></div>
          ${t.is_played&&a`<div><dt>Skills</dt><dd>played by their documents</dd></div>`}
          ${t.sandbox&&a`<div><dt>Documents</dt><dd>${t.sandbox}</dd></div>`}
        </dl>`}
        ${(s?.ends??[]).map(_=>a`<p class="aside"><b>${_.name}</b> ended after ${_.after_s.toFixed(1)} s, ${_.how}: ${_.then}</p>`)}
      <//>
      <${C} id="bundles" title="Documents">
        <ul class="bundles">${i.map(_=>a`<li><b>${_.project}</b> revision ${_.revision}<span class="muted">${_.skills.join(", ")}</span></li>`)}</ul>
        ${e.is_running&&a`<${Co} run=${e.run} />`}
      <//>
    </div>
  </div>`:null}function Co({run:e}){let[t,n]=$(null),[s,o]=$("");async function i(r){let c=r.target.files[0];if(c){o(`Sending ${c.name}…`),n(null);try{let d=await ct(`/v1/runs/${encodeURIComponent(e)}/bundles`,c),l=[...d.added??[],...d.changed??[]].join(", ");o(`Accepted: revision ${d.revision}${l?`, ${l}`:", nothing new"}.`)}catch(d){o(""),n(d)}r.target.value=""}}return a`<div class="push">
    ${q()?a`<label class="button">Give it documents…<input type="file" class="visually-hidden" onChange=${i} accept=".zip,.tar,.gz,.tgz,.xz,.bz2,.ef,.sd,.am,.lf,.json" /></label>
          <p class="note">A document, or an archive of some. They take over at a decision, and the mission goes on.</p>`:a`<p class="note">Open the address that <code>aos serve</code> prints to change something here.</p>`}
    <p role="status">${s}</p>
    <${j} problem=${t} />
  </div>`}var Mo={overview:"Overview",why:"Why",steps:"Steps",model:"Model",documents:"Documents",system:"System"},To={overview:No,why:ds,steps:hs,model:fs,documents:ms,system:_s};function $s(){let{name:e,view:t}=w.value;k(()=>(ft(e),zn),[e]);let n=g.value?.step,s=g.value&&!g.value.status;if(k(()=>{if(!n)return;let i=setTimeout(()=>Bn(n),60);return()=>clearTimeout(i)},[e,n,s]),X.value&&!D.value)return a`<main id="main" class="page"><h1>${e}</h1><${j} problem=${X.value} /><p><a href="#/">All missions</a></p></main>`;let o=To[t];return a`<main id="main" class="page">
    <${Eo} />
    <${ts} />
    <div class="hero card">
      <${is} />
      <${os} />
    </div>
    <nav class="views" aria-label="Views">
      ${Dt.map(i=>a`<a href=${P(e,i,w.value.step)} aria-current=${i===t?"page":null}>${Mo[i]}</a>`)}
    </nav>
    <${o} />
  </main>`}function Eo(){let e=D.value,t=E.value,n=t?.phase==="ended",s=g.value&&(me.value||g.value===Fe.value?g.value.endings_after??g.value.endings:g.value.endings_after??g.value.endings),o=s?.goal??t?.goal_probability;return a`<header class="head">
    <div class="head-name">
      <h1>${e?.robot??" "}</h1>
      <p class="muted">${w.value.name}</p>
    </div>
    <div class="head-state">
      <p class=${`phase is-${n?t.ending:t?.phase??"waiting"}`} role="status">
        <i class=${n||!e?.is_running?"still-dot":"pulse"}></i>${n?mt(t.ending):Kn(t?.phase??"waiting")}
        ${!me.value&&a`<span class="past">showing step ${g.value?.step}</span>`}
      </p>
      <p class="remark">${t?.remark??""}</p>
      <${Oo} />
    </div>
    <div class="goal" title="How probable the goal is, as the belief has it">
      <span class="goal-number">${O(o)}</span><span class="goal-word">goal</span>
      <svg viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true"><rect width="100" height="4" class="goal-rail" /><rect width=${(o??0)*100} height="4" class="goal-bar" /></svg>
      ${s?.failure>5e-4&&a`<span class="failure">failure ${O(s.failure)}</span>`}
    </div>
    <${Qn} />
  </header>`}function Oo(){let e=[...new Set(dt.value.map(s=>s.skill))];if(!e.length)return null;let{name:t,step:n}=w.value;return a`<p><a class="alarm" href=${P(t,"model",n)}><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="M5 0 l5 9.5 h-10z" /></svg>The model of ${e.join(", ")} does not hold</a></p>`}function No(){return a`<div class="columns overview">
    <div class="stack">
      <${C} id="belief" title="Belief" note=${Ro()}><${as} /><//>
      <${vs} />
      <${C} id="all-steps" title="Steps"><${Kt} /><//>
    </div>
    <div class="stack">
      <${C} id="values" title="Values of the actions"><${cs} /><${es} /><//>
      ${J.value.length>0&&a`<${C} id="world" title="World"><${Ao} /><//>`}
    </div>
  </div>`}var Ro=()=>V.value.length?`After ${me.value?"the newest step":`step ${g.value?.step}`}.`:"";function Ao(){let e=J.value,t=g.value?.step??0,n=e.filter(s=>s<=t).at(-1)??e[0];return n===void 0?null:a`<figure class="picture"><img src=${`/v1/missions/${encodeURIComponent(w.value.name)}/world/${n}`} alt=${`The world after step ${n}`} />
    <figcaption class="note">After step ${n}</figcaption></figure>`}var Jt="aos-theme",gs=e=>e?document.documentElement.dataset.theme=e:delete document.documentElement.dataset.theme;gs(localStorage.getItem(Jt));var jo={live:"Live",lost:"Connection lost, trying again",connecting:"Connecting",over:"Recorded"};function Io(){let{kind:e,name:t}=w.value,n=e==="missions"&&t;return k(()=>{e==="runs"&&t?Po(t):n||(Le(),pt())},[e,t]),a`
    <a class="skip" href="#main" onClick=${s=>{s.preventDefault(),document.getElementById("main")?.focus()}}>To the content</a>
    <header class="bar">
      <a class="brand" href="#/" aria-label="AOS, all missions"><svg viewBox="0 0 32 32" width="22" height="22" aria-hidden="true"><rect width="32" height="32" rx="8" /><path d="M6 21c5 0 5-10 10-10s5 10 10 10" /><circle cx="16" cy="11" r="3.2" /></svg><span>AOS</span></a>
      ${n&&a`<nav aria-label="Place"><a href="#/">Missions</a></nav>`}
      <span class="room"></span>
      <span class=${`connection is-${Z.value}`} role="status"><i></i>${n||Z.value==="lost"?jo[Z.value]:""}</span>
      <${Do} />
    </header>
    ${n?a`<${$s} key=${t} />`:a`<${Zn} />`}`}async function Po(e){await Le();let t=(xe.value??[]).find(n=>n.run===e);ie(P(t?.missions?.at(-1)??e),{replace:!0})}function Do(){let[e,t]=$(localStorage.getItem(Jt)??""),n=e?e==="dark":matchMedia("(prefers-color-scheme: dark)").matches;function s(){let o=n?"light":"dark";localStorage.setItem(Jt,o),gs(o),t(o)}return a`<button class="quiet theme" onClick=${s} aria-label=${n?"Light colours":"Dark colours"} title=${n?"Light colours":"Dark colours"}>${n?"☀":"☾"}</button>`}addEventListener("keydown",e=>{if(!(e.target instanceof Element&&e.target.closest("input, select, textarea, .scroll, .source, [role=tab]")||e.ctrlKey||e.metaKey||e.altKey||!g.value)){if(e.key==="ArrowLeft")U(g.value.step-1);else if(e.key==="ArrowRight")U(g.value.step+1);else if(e.key==="Home")U(M.value[0].step);else if(e.key==="End")U(null);else return;e.preventDefault()}});await Fn();Mt(a`<${Io} />`,document.getElementById("page"));
